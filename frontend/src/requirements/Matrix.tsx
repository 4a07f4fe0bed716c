// The table of requirements and runs.
import { IconAlertTriangle, IconCircleCheck, IconCircleX, IconClock, IconDice, IconHelpCircle, IconSignature } from '@tabler/icons-react'
import { Link } from '@tanstack/react-router'
import { clsx } from 'clsx'
import type { RequirementRow, RequirementRun } from '../client'
import { NONE } from '../format/numbers'
import { TextButton } from '../ui/Button'
import { Digest } from '../ui/Digests'
import { RunLink } from '../ui/RunLink'
import { Badge } from '../ui/VerdictBadge'
import { SignedBy } from '../signoffs/SignedBy'
import { DateCell, marginOf, OutcomeBadge } from '../trends/cells'
import { leftOut, type Status, STATUSES } from './status'
import { layout, tables } from '../ui/styles'
import styles from './requirements.module.css'

const ICONS: Record<Status, typeof IconClock> = {
  violated: IconCircleX,
  inconclusive: IconHelpCircle,
  'not sampled': IconDice,
  'no verdict': IconClock,
  suspect: IconAlertTriangle,
  unsigned: IconSignature,
  'no evidence': IconHelpCircle,
  met: IconCircleCheck,
}

interface MatrixProps {
  rows: readonly RequirementRow[]
  /** Absent for users who may not change requirements. */
  onChange: ((row: RequirementRow) => void) | undefined
}

export function Matrix({ rows, onChange }: MatrixProps) {
  return (
    <table className={clsx(tables.table, tables.stack, styles.matrix)}>
      <thead>
        <tr>
          <th>Requirement</th>
          <th>Status</th>
          <th>Run</th>
          <th>Verdict</th>
          <th className="num">Worst margin</th>
          <th>Campaign, evidence, sha256</th>
          <th>Date</th>
          <th>Sign-off</th>
        </tr>
      </thead>
      {rows.map((row) => (
        <tbody key={row.id} data-requirement={row.id}>
          <tr>
            <td rowSpan={Math.max(1, row.runs.length)} className={styles.what}>
              <What row={row} onChange={onChange} />
            </td>
            <td rowSpan={Math.max(1, row.runs.length)} className={styles.why}>
              <StatusBadge status={row.status} />
              <p className="small sec">{row.sentence}</p>
            </td>
            {row.runs.length === 0 ? (
              <td colSpan={6} className="mut">
                {leftOut(row) || NONE}
              </td>
            ) : (
              <Cells run={row.runs[0] as RequirementRun} />
            )}
          </tr>
          {row.runs.slice(1).map((run) => (
            <tr key={run.id}>
              <Cells run={run} />
            </tr>
          ))}
        </tbody>
      ))}
    </table>
  )
}

export function StatusBadge({ status }: { status: Status }) {
  const { word, tone } = STATUSES[status]
  return <Badge tone={tone} Icon={ICONS[status]}>{word}</Badge>
}

function What({ row, onChange }: { row: RequirementRow; onChange: MatrixProps['onChange'] }) {
  const more = row.runs.length > 0 && leftOut(row)
  return (
    <>
      <span className={clsx(layout.row, 'b')}>
        <span className={layout.wrapAny}>{row.id}</span>
        {onChange && !row.file?.match(/\.(reqif|xml)$/i) && (
          <TextButton className={clsx('small', styles.change)} aria-label={`${row.registered ? 'Change' : 'Register'} ${row.id}`} onClick={() => onChange(row)}>
            {row.registered ? 'Change …' : 'Register …'}
          </TextButton>
        )}
      </span>
      <p className={clsx(layout.wrapAny, styles.text)}>{row.text || <span className="mut">no text</span>}</p>
      <p className="small mut">
        {row.file ? `from ${row.file}` : row.registered ? 'written here' : 'stated by campaigns only'}
        {more && `; ${more}`}
      </p>
    </>
  )
}

function Cells({ run }: { run: RequirementRun }) {
  return (
    <>
      <td data-label="Run">
        <span className={tables.rn}>
          <RunLink run={run.id} />
          <small>{run.campaign_name}</small>
          {run.role && <small>{run.role}</small>}
        </span>
      </td>
      <td data-label="Verdict">
        <OutcomeBadge outcome={run} />
      </td>
      <td data-label="Worst margin" className={clsx('num nw', run.margin !== null && run.margin <= 0 && 'bad-t')}>{marginOf(run)}</td>
      <td data-label="Campaign">
        <Link to="/trends" search={{ name: run.campaign_name }} className="mono" title={run.campaign_digest}>
          {run.campaign_digest.slice(0, 12)}
        </Link>
        {run.evidence_digest && <p className="small mut">evidence <Digest of={run.evidence_digest} /></p>}
      </td>
      <td data-label="Date">
        <DateCell outcome={run} />
      </td>
      <td data-label="Sign-off" className={clsx(layout.wrapAny, styles.signed)}>
        {run.signoffs.length > 0 ? <SignedBy items={run.signoffs} /> : <span className="mut">{run.verdict ? 'none' : NONE}</span>}
      </td>
    </>
  )
}
