// The drafts stored on the service: user, time, open, delete.
import { IconTrash } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import { useState } from 'react'
import { deleteDraft } from '../../api/calls'
import { useChange } from '../../api/change'
import { useBarredFromOwn } from '../../api/may'
import { draftsQuery } from '../../api/queries'
import type { DraftSummary } from '../../client'
import { count } from '../../format/numbers'
import { moment, when } from '../../format/time'
import { TextButton } from '../../ui/Button'
import { Card, Tags } from '../../ui/Card'
import { buttonColumn, type Column, Table } from '../../ui/Table'
import { Form } from '../../ui/Form'
import { IconButton } from '../../ui/IconButton'
import { Modal } from '../../overlay/Modal'
import { RunLink } from '../../ui/RunLink'
import { useNow } from '../../ui/useNow'
import { layout } from '../../ui/styles'
import styles from './draft.module.css'

const FEW = 4

export function Drafts() {
  const { data } = useQuery(draftsQuery)
  const [all, setAll] = useState(false)
  const [leaving, setLeaving] = useState<DraftSummary | null>(null)
  const now = useNow(30_000)
  if (!data || data.length === 0) return null
  const columns: Column<DraftSummary>[] = [
    {
      head: 'Draft',
      cell: ({ id }) => (
        <Link to="/launch" search={{ draft: id }} className="mono nw">
          {id}
        </Link>
      ),
    },
    { head: 'Name', tone: layout.wrapAny, label: 'Name', cell: ({ name }) => name || <span className="mut">Untitled</span> },
    { head: 'Tags', className: layout.hideN, label: ({ tags }) => (tags.length > 0 ? 'Tags' : undefined), cell: ({ tags }) => <Tags tags={tags} /> },
    {
      head: 'Saved by',
      label: 'Saved by',
      cell: ({ owner, saved_by }) => [saved_by, owner !== saved_by && <span key="owner" className="mut">, begun by {owner}</span>],
    },
    { head: 'Saved', tone: 'nw', label: 'Saved', tip: ({ saved }) => moment(saved), cell: ({ saved }) => when(saved, now) },
    { head: 'Run', label: ({ run }) => (run ? 'Run' : undefined), cell: ({ run }) => run && <RunLink run={run} className="mono" /> },
    buttonColumn('Delete', (draft) => <Delete draft={draft} onAsk={() => setLeaving(draft)} />, layout.acts),
  ]
  const shown = all ? data : data.slice(0, FEW)
  return (
    <Card
      title="Drafts"
      note="Saved campaigns that have not been started."
      className={styles.drafts}
      flush
      footer={
        shown.length < data.length && (
          <TextButton onClick={() => setAll(true)}>Show {count(data.length - shown.length)} more</TextButton>
        )
      }
    >
      <Table stack rows={shown} by={({ id }) => id} columns={columns} />
      <Modal opened={leaving !== null} onClose={() => setLeaving(null)} title={`Delete draft ${leaving?.id ?? ''}`}>
        {leaving && <Deletion draft={leaving} onDone={() => setLeaving(null)} />}
      </Modal>
    </Card>
  )
}

function Delete({ draft, onAsk }: { draft: DraftSummary; onAsk: () => void }) {
  const barred = useBarredFromOwn('engineer', draft)
  return (
    <IconButton bare label={`Delete draft ${draft.id}`} title={barred ?? 'Delete'} icon={IconTrash} off={barred !== undefined} act={onAsk} />
  )
}

function Deletion({ draft, onDone }: { draft: DraftSummary; onDone: () => void }) {
  const removal = useChange(() => deleteDraft(draft.id, draft.version), ['drafts'], onDone)
  return (
    <Form sent={removal} send="Delete" onSend={() => removal.mutate()} leave="Keep it" onLeave={onDone}>
      <p>
        {draft.name || 'This untitled draft'} will be deleted for all users. Runs started from it remain.
      </p>
    </Form>
  )
}
