// Parts of the cells of the run list.
import { clsx } from 'clsx'
import { IconPinned } from '@tabler/icons-react'
import type { RunSummary } from '../client'
import { decimalsFor, NONE, short } from '../format/numbers'
import { moment, when } from '../format/time'
import { RunLink } from '../ui/RunLink'
import { layout, tables } from '../ui/styles'
import styles from './runs.module.css'

export interface CellContext {
  /** Units are in the cells because rows differ. */
  units: boolean
  now: number
  onTag: (tag: string) => void
  onLabel: (label: string) => void
}

/** The first column, always shown: name, number, what columns that are not shown have for it, pin. */
export function RunName({ run, asides }: { run: RunSummary; asides: readonly string[] }) {
  return (
    <span className={clsx(tables.rn, styles.rn)}>
      <span className={layout.cut}>
        {run.pinned && <IconPinned className="i s mut" aria-label="Pinned" />}{' '}
        <RunLink run={run.id} title={run.name}>{run.name}</RunLink>
      </span>
      <small className={layout.cut}>
        {run.id}
        {asides.map((text) => ` · ${text}`)}
        {run.continues && ` · extends ${run.continues}`}
      </small>
    </span>
  )
}

/** A value in the criterion's unit; a power of ten where its column would cut off its last digits. */
export function amount(value: number | null, run: Pick<RunSummary, 'worst_cost' | 'threshold' | 'unit'>, { units }: Pick<CellContext, 'units'>): string {
  const text = short(value, decimalsFor([run.worst_cost, run.threshold]))
  return units && value !== null && run.unit ? `${text} ${run.unit}` : text
}

export function Time({ at, now }: { at: number | null; now: number }) {
  if (at === null) return NONE
  return (
    <time dateTime={new Date(at * 1000).toISOString()} title={moment(at)}>
      {when(at, now)}
    </time>
  )
}

/** Why, when and by whom a run was removed. */
export function Removal({ run, now }: { run: RunSummary; now: number }) {
  return (
    <span className={clsx(tables.rn, styles.rn)} title={run.removed_reason ?? undefined}>
      <span className={layout.cut}>{run.removed_reason}</span>
      <small className={layout.cut}>
        <Time at={run.removed} now={now} /> by {run.removed_by}
      </small>
    </span>
  )
}
