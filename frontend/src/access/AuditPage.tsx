// The audit trail for reviewers and administrators: in pages, newest first, by user and action; its head, and its export.
import { clsx } from 'clsx'
import { IconDownload } from '@tabler/icons-react'
import { useInfiniteQuery } from '@tanstack/react-query'
import { useNavigate, useSearch } from '@tanstack/react-router'
import { paged } from '../api/queries'
import { type AuditEntry, type AuditPage as Page, listAudit } from '../client'
import { count } from '../format/numbers'
import { viaOf } from '../format/people'
import { moment } from '../format/time'
import { Loaded } from '../page/Trouble'
import { ButtonAnchor, TextButton } from '../ui/Button'
import { Card } from '../ui/Card'
import { ShowMore } from '../ui/ShowMore'
import { type Column, Table } from '../ui/Table'
import { Digests } from '../ui/Digests'
import { CopyButton } from '../ui/files'
import { AccessFrame } from './AccessFrame'
import { at } from '../format/root'
import styles from './access.module.css'
import { fields } from '../ui/styles'

const auditQuery = (actor: string, action: string) =>
  paged(['audit', actor, action], (cursor) => listAudit({ query: { actor, action, ...(cursor ? { cursor } : {}) } }), 0)

export function AuditPage() {
  const { actor = '', action = '' } = useSearch({ from: '/access/audit' })
  const navigate = useNavigate({ from: '/access/audit' })
  const query = useInfiniteQuery(auditQuery(actor, action))
  const first = query.data?.pages[0]
  return (
    <AccessFrame
      title="Audit trail"
      actions={
        first && (
          <ButtonAnchor icon={IconDownload} href={at('/api/v1/audit/export')} download="clearance-audit.jsonl">
            Export as JSON lines
          </ButtonAnchor>
        )
      }
    >
      <Loaded query={query} what="audit trail">
        {(data) => first && (
          <>
            <Filters page={first} actor={actor} action={action} />
            <Card
              title="What was done"
              note={`${count(first.total)} ${first.total === 1 ? 'row' : 'rows'} in all; each holds the hash of the one before`}
              flush
              footer={query.hasNextPage && <ShowMore query={query} total={first.total} words="Show earlier ones" />}
            >
              <EntriesList entries={data.pages.flatMap((page) => page.items)} onAll={() => void navigate({ search: {}, replace: true })} />
            </Card>
            <Card title="Head" note="Number and hash of the newest row" right={<CopyButton text={() => first.head}>Copy the head</CopyButton>}>
              <code className={`mono ${styles.secret ?? ''}`}>{first.head}</code>
              <p className="small sec">
                Note it where this service cannot write. <code>clearance trail verify --head HEAD</code> then shows whether rows up to it were changed
                or are missing; without a noted head, whoever may write the database could compute the whole chain again.
              </p>
            </Card>
          </>
        )}
      </Loaded>
    </AccessFrame>
  )
}

function Filters({ page, actor, action }: { page: Page; actor: string; action: string }) {
  const navigate = useNavigate({ from: '/access/audit' })
  const set = (change: { actor?: string; action?: string }) =>
    void navigate({ search: (before) => ({ ...before, ...change }), replace: true })
  return (
    <div className={styles.filters}>
      <Choice label="User or token" value={actor} options={page.actors} onChange={(text) => set({ actor: text })} />
      <Choice label="Action" value={action} options={page.actions} onChange={(text) => set({ action: text })} />
    </div>
  )
}

interface ChoiceProps {
  label: string
  value: string
  options: readonly string[]
  onChange: (value: string | undefined) => void
}

function Choice({ label, value, options, onChange }: ChoiceProps) {
  const all = value && !options.includes(value) ? [value, ...options] : options
  return (
    <label className={fields.lbl}>
      {label}
      <select className={fields.inp} value={value} onChange={(event) => onChange(event.target.value || undefined)}>
        <option value="">any</option>
        {all.map((option) => (
          <option key={option}>{option}</option>
        ))}
      </select>
    </label>
  )
}

function EntriesList({ entries, onAll }: { entries: readonly AuditEntry[]; onAll: () => void }) {
  if (entries.length === 0)
    return (
      <p className={clsx('sec', styles.none)}>
        No row matches.{' '}
        <TextButton onClick={onAll}>Show all rows</TextButton>
      </p>
    )
  return <Table stack rows={entries} by={({ id }) => id} columns={COLUMNS} />
}

const COLUMNS: readonly Column<AuditEntry>[] = [
  { head: 'Row', num: true, label: 'Row', cell: ({ id }) => id },
  { head: 'When', tone: 'sec nw', label: 'When', cell: ({ at }) => moment(at) },
  { head: 'User', tone: styles.who, label: 'User', cell: (entry) => [`${entry.account} `, <span key="via" className="mut">{viaOf(entry)}</span>] },
  { head: 'Action', tone: 'nw', label: 'Action', cell: ({ action }) => action },
  { head: 'Subject', tone: styles.who, label: 'Subject', cell: ({ subject }) => subject },
  {
    head: 'Detail',
    tone: clsx('small sec', styles.detail),
    label: ({ detail }) => (Object.keys(detail).length > 0 ? 'Detail' : undefined),
    cell: ({ detail }) => <Digests text={detailText(detail)} />,
  },
  { head: 'Hash', label: 'Hash', tip: ({ hash }) => hash, cell: ({ hash }) => <span className="mono">{hash.slice(0, 8)}</span> },
]

/** The details as `name: value`, in the order in which they were stored. */
function detailText(detail: AuditEntry['detail']): string {
  return Object.entries(detail)
    .map(([name, value]) => `${name}: ${typeof value === 'string' ? value : JSON.stringify(value)}`)
    .join(', ')
}
