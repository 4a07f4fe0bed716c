// Cells that the tables of outcomes share.
import type { Outcome } from '../client'
import { boundText } from '../format/counts'
import { decimalsFor, margin, NONE } from '../format/numbers'
import { rfc3339, when } from '../format/time'
import { unreadOf } from './code'
import { Digest } from '../ui/Digests'
import { RunLink } from '../ui/RunLink'
import type { Column } from '../ui/Table'
import { RunBadge } from '../ui/VerdictBadge'
import { tables } from '../ui/styles'

/** The verdict or the state of a run, as icon and word. */
export function OutcomeBadge({ outcome }: { outcome: Outcome | null }) {
  return outcome ? <RunBadge run={outcome} /> : <span className="mut">Purged</span>
}

export const marginOf = (outcome: Outcome | null): string => {
  if (outcome?.margin === null || outcome?.margin === undefined) return NONE
  return `${margin(outcome.margin, decimalsFor([outcome.worst_cost, outcome.threshold]))} ${outcome.unit}`.trim()
}

export const boundOf = (outcome: Outcome | null): string =>
  outcome?.upper_bound === null || outcome?.upper_bound === undefined ? NONE : `≤ ${boundText(outcome)}`

/** campaign: its name, shown where the run's is another one. */
export function RunCell({ run, name, campaign = name }: { run: string; name?: string; campaign?: string }) {
  return (
    <span className={tables.rn}>
      <RunLink run={run}>{name}</RunLink>
      {name && <small>{campaign === name ? run : `${run} · ${campaign}`}</small>}
    </span>
  )
}

export const CodeCell = ({ code, unidentified }: Pick<Outcome, 'code' | 'unidentified'>) =>
  code ? <Digest of={code} first={12} /> : <span className="mut">{unreadOf({ unidentified })}</span>

/** When it ended, or was submitted if it has not ended. */
export function DateCell({ outcome }: { outcome: Outcome }) {
  const at = outcome.finished ?? outcome.created
  return (
    <time className="sec nw" dateTime={rfc3339(at)} title={rfc3339(at)}>
      {outcome.finished === null && 'submitted '}
      {when(at)}
    </time>
  )
}

/** Verdict, name, worst margin and bound of runs; further ones after the name. What a run without a verdict found has a
 * column of its own if there is such a run. */
export const outcomeColumns = <T extends Outcome>(runs: readonly T[], ...further: Column<T>[]): (Column<T> | false)[] => [
  { head: 'Verdict', cell: (run) => <OutcomeBadge outcome={run} /> },
  { head: 'Run', cell: ({ id, name }) => <RunCell run={id} name={name} /> },
  ...further,
  { head: 'Worst margin', num: true, cell: marginOf },
  { head: 'P(violation)', num: true, tone: 'sec', cell: boundOf },
  runs.some((run) => run.unconfirmed) && { head: 'Without a verdict', tone: 'sec', cell: (run) => run.unconfirmed },
]
