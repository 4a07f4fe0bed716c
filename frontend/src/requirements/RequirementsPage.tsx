// Requirements and the runs that are evidence for them: a group of rows for each requirement, a row for each run.
import { IconDownload, IconPlus, IconUpload } from '@tabler/icons-react'
import { useInfiniteQuery, useQuery } from '@tanstack/react-query'
import { Link, useNavigate, useSearch } from '@tanstack/react-router'
import { useState } from 'react'
import { hasRole } from '../api/access'
import { isLive, sessionQuery } from '../api/queries'
import { EXPORTS, requirementsQuery } from '../api/requirements'
import type { RequirementRow } from '../client'
import { count } from '../format/numbers'
import { PageHead } from '../page/PageHead'
import { Unloaded } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { MenuItem } from '../overlay/later'
import { Button, TextButton, worded } from '../ui/Button'
import { ShowMore } from '../ui/ShowMore'
import { Card } from '../ui/Card'
import { SearchBox } from '../ui/SearchBox'
import { Modal } from '../overlay/Modal'
import { Popup } from '../overlay/Popup'
import { usePolling } from '../ui/usePolling'
import { Files } from './Files'
import { ImportForm } from './ImportForm'
import { Matrix } from './Matrix'
import { countsOf, isStatus, STATUSES, type Status } from './status'
import { WriteForm } from './WriteForm'
import { EntryLines } from '../ui/EntryLines'
import { Select } from '../ui/Select'
import { layout } from '../ui/styles'

type Dialog = 'import' | 'add' | RequirementRow | null

export function RequirementsPage() {
  useTitle('Requirements')
  const { q = '', status } = useSearch({ from: '/requirements' })
  const navigate = useNavigate({ from: '/requirements' })
  const search = (text: string) => void navigate({ search: (old) => ({ ...old, q: text || undefined }), replace: true })
  const only = (next: Status | undefined) => void navigate({ search: (old) => ({ ...old, status: next }), replace: true })
  const [dialog, setDialog] = useState<Dialog>(null)
  const query = useInfiniteQuery(requirementsQuery(q))
  const mayChange = hasRole(useQuery(sessionQuery).data?.role, 'engineer')
  const items = query.data?.pages.flatMap((page) => page.items) ?? []
  const active = items.some(({ runs }) => runs.some(isLive))
  usePolling(() => query.refetch(), 10_000, active)
  if (!query.data)
    return (
      <>
        <PageHead title="Requirements" />
        <Unloaded query={query} what="requirements" below />
      </>
    )
  const total = query.data.pages[0]?.total ?? items.length
  const shown = status ? items.filter((row) => row.status === status) : items
  const done = () => setDialog(null)
  return (
    <>
      <PageHead title="Requirements">
        <ExportFiles disabled={total === 0 && q === ''} />
        {mayChange && (
          <>
            <Button icon={IconPlus} onClick={() => setDialog('add')}>Add</Button>
            <Button main icon={IconUpload} onClick={() => setDialog('import')}>Import</Button>
          </>
        )}
      </PageHead>
      <div className={layout.filters}>
        <SearchBox label="Search requirements" hint="Id or text" value={q} onChange={search} />
        <Select
          label="Status"
          value={status ?? ''}
          options={[{ value: '', label: 'Every status' }, ...Object.entries(STATUSES).map(([value, { word }]) => ({ value, label: word }))]}
          onChange={(value) => only(isStatus(value) ? value : undefined)}
        />
        <span className="small mut" aria-live="polite">
          {counted(items, total)}
        </span>
      </div>
      <Card
        title="Matrix"
        note="The worst evidence for a requirement decides its status"
        flush={shown.length > 0}
        footer={query.hasNextPage && <ShowMore query={query} total={total} />}
      >
        {shown.length > 0 ? <Matrix rows={shown} onChange={mayChange ? setDialog : undefined} /> : <Nothing of={query.hasNextPage ? items.length : null} narrowed={Boolean(q || status)} onAll={() => void navigate({ search: {}, replace: true })} />}
      </Card>
      <Files mayChange={mayChange} />
      <Modal opened={dialog === 'import'} onClose={done} title="Import requirements">
        <ImportForm onDone={done} />
      </Modal>
      <Modal opened={dialog !== null && dialog !== 'import'} onClose={done} title={dialog === 'add' ? 'Add a requirement' : 'Change a requirement'}>
        {dialog !== null && dialog !== 'import' && <WriteForm row={dialog === 'add' ? null : dialog} onDone={done} />}
      </Modal>
    </>
  )
}

/** How many there are of each status among those that are loaded. */
function counted(items: readonly RequirementRow[], total: number): string {
  const parts = countsOf(items).map(([status, number]) => `${count(number)} ${STATUSES[status].word.toLowerCase()}`)
  const some = items.length < total ? `The first ${count(items.length)} of ${count(total)}` : `${count(total)} ${total === 1 ? 'requirement' : 'requirements'}`
  return [some, ...(parts.length ? [parts.join(', ')] : [])].join(': ')
}

/** `of` is the number of those that were looked at, where there are more. */
function Nothing({ of, narrowed, onAll }: { of: number | null; narrowed: boolean; onAll: () => void }) {
  if (narrowed)
    return (
      <p className="sec">
        {of === null ? 'No requirement matches.' : `None of the first ${count(of)} matches.`}{' '}
        <TextButton onClick={onAll}>Show all requirements</TextButton>
      </p>
    )
  return (
    <p className="sec">
      There are no requirements yet. Import a CSV or ReqIF file, or name them in the criterion of a campaign; see{' '}
      <Link to="/help/guides/$name" params={{ name: 'requirements' }}>
        the guide
      </Link>
      .
    </p>
  )
}

function ExportFiles({ disabled }: { disabled: boolean }) {
  return (
    <Popup
      kind="menu"
      width={320}
      button={{ ...worded(IconDownload, 'Export'), disabled }}
    >
      {EXPORTS.map(({ href, title, text }) => (
        <MenuItem key={href} component="a" href={href} download>
          <EntryLines title={title}>{text}</EntryLines>
        </MenuItem>
      ))}
    </Popup>
  )
}
