// The columns of the run list: names, widths, sort orders and cells.
import { clsx } from 'clsx'
import type { ReactNode } from 'react'
import type { RunSummary } from '../client'
import { withoutValue } from '../format/counts'
import { count, duration, NONE, percent } from '../format/numbers'
import { MethodName } from '../ui/MethodMark'
import { Sign } from '../ui/Sign'
import { outcomeOf, VerdictBadge } from '../ui/VerdictBadge'
import { amount, Margin, Removal, Tags, Time } from './cells'
import type { ColumnKey } from './columnKeys'
import type { SortKey } from './search'
import { Spark } from './Spark'
import layout from '../ui/layout.module.css'

export interface CellContext {
  /** Units are in the cells because rows differ. */
  units: boolean
  now: number
  onTag: (tag: string) => void
  onLabel: (label: string) => void
}

/** Common properties of the rows, for the headers. */
export interface Common {
  quantity: string
  /** Undefined if rows differ. */
  unit: string | undefined
}

export interface Column {
  key: ColumnKey | 'removal'
  /** In the menu of columns. */
  name: string
  head: (common: Common) => ReactNode
  /** Second line of the header. */
  under?: (common: Common) => ReactNode
  /** [px] */
  width: number
  sort?: SortKey
  /** Right padding of the header, if the numbers are not at the right edge [px]. */
  inset?: number
  /** Sorted downwards at first. */
  down?: boolean
  num?: boolean
  /** Part of a result: a run without one shows its state instead. */
  result?: boolean
  cell: (run: RunSummary, context: CellContext) => ReactNode
}

const unitOf = ({ unit }: Common): string => unit ?? ''
const named = (text: string) => () => text
export const COLUMNS: readonly (Column & { key: ColumnKey })[] = [
  {
    key: 'verdict',
    name: 'Verdict',
    head: named('Verdict'),
    width: 130,
    sort: 'verdict',
    cell: (run) => <VerdictBadge outcome={outcomeOf(run)} />,
  },
  {
    key: 'worst',
    name: 'Worst value',
    head: ({ quantity }) => <>Worst {quantity ? <Sign text={quantity} /> : 'value'}</>,
    under: unitOf,
    width: 80,
    sort: 'worst',
    num: true,
    result: true,
    cell: (run, context) => <span className="m">{amount(run.worst_cost, run, context)}</span>,
  },
  {
    key: 'nominal',
    name: 'Nominal value',
    head: named('Nominal'),
    under: unitOf,
    width: 84,
    sort: 'nominal',
    num: true,
    result: true,
    cell: (run, context) => <span className="sec">{amount(run.nominal_cost, run, context)}</span>,
  },
  {
    key: 'criterion',
    name: 'Criterion',
    head: named('Criterion'),
    under: unitOf,
    width: 70,
    sort: 'criterion',
    num: true,
    result: true,
    cell: (run, { units }) => (
      <span className="sec">
        {run.threshold ?? NONE}
        {units && run.unit ? ` ${run.unit}` : ''}
      </span>
    ),
  },
  {
    key: 'margin',
    name: 'Margin',
    head: named('Margin'),
    under: unitOf,
    width: 136,
    inset: 67,
    sort: 'margin',
    num: true,
    result: true,
    cell: (run, context) => <Margin run={run} context={context} />,
  },
  {
    key: 'method',
    name: 'Found by',
    head: named('Found by'),
    width: 100,
    sort: 'method',
    result: true,
    cell: (run) =>
      run.worst_method ? <MethodName method={run.worst_method} short /> : <span className="mut">{NONE}</span>,
  },
  {
    key: 'bound',
    name: 'P(violation) bound',
    head: named('P(violation)'),
    under: named('upper bound'),
    width: 92,
    sort: 'bound',
    num: true,
    result: true,
    cell: (run) =>
      run.upper_bound === null ? (
        <span className="mut">not sampled</span>
      ) : (
        <span className="sec">≤ {percent(run.upper_bound)}</span>
      ),
  },
  {
    key: 'evaluations',
    name: 'Evaluations',
    head: named('Evaluations'),
    width: 92,
    sort: 'evaluations',
    down: true,
    num: true,
    result: true,
    cell: (run) => (
      <span className="sec" title={withoutValue(run)}>
        {count(run.evaluations)}
      </span>
    ),
  },
  {
    key: 'failed',
    name: 'Failed evaluations',
    head: named('Failed'),
    under: named('evaluations'),
    width: 84,
    sort: 'failed',
    down: true,
    num: true,
    result: true,
    cell: (run) => <span className={run.failed_evaluations ? 'b' : 'sec'}>{count(run.failed_evaluations)}</span>,
  },
  {
    key: 'excluded',
    name: 'Excluded evaluations',
    head: named('Excluded'),
    under: named('evaluations'),
    width: 84,
    num: true,
    result: true,
    cell: (run) => <span className={run.excluded_evaluations ? 'b' : 'sec'}>{count(run.excluded_evaluations)}</span>,
  },
  {
    key: 'course',
    name: 'Best so far',
    head: ({ quantity }) => <>Best {quantity ? <Sign text={quantity} /> : 'value'} so far</>,
    under: named('evaluations, log'),
    width: 116,
    cell: (run) => (
      <Spark
        course={run.best_so_far}
        evaluations={run.evaluations}
        threshold={run.threshold}
        violated={run.margin !== null && run.margin <= 0}
      />
    ),
  },
  {
    key: 'campaign',
    name: 'Campaign',
    head: named('Campaign'),
    width: 190,
    sort: 'campaign',
    cell: (run) => <span className={clsx(layout.cut, 'sec')}>{run.campaign_name}</span>,
  },
  {
    key: 'tags',
    name: 'Tags',
    head: named('Tags'),
    width: 176,
    sort: 'tags',
    cell: (run, { onTag, onLabel }) => <Tags run={run} onTag={onTag} onLabel={onLabel} />,
  },
  {
    key: 'duration',
    name: 'Duration',
    head: named('Duration'),
    width: 80,
    sort: 'duration',
    down: true,
    num: true,
    cell: (run, { now }) => (
      <span className="sec">{run.started ? duration((run.finished ?? now) - run.started) : NONE}</span>
    ),
  },
  {
    key: 'submitted',
    name: 'Submitted',
    head: named('Submitted'),
    width: 94,
    sort: 'created',
    down: true,
    cell: (run, { now }) => <span className="sec nw"><Time at={run.created} now={now} /></span>,
  },
  {
    key: 'started',
    name: 'Started',
    head: named('Started'),
    width: 100,
    sort: 'started',
    down: true,
    cell: (run, { now }) => <span className="sec nw"><Time at={run.started} now={now} /></span>,
  },
  {
    key: 'finished',
    name: 'Finished',
    head: named('Finished'),
    width: 100,
    sort: 'finished',
    down: true,
    cell: (run, { now }) => <span className="sec nw"><Time at={run.finished} now={now} /></span>,
  },
  {
    key: 'owner',
    name: 'User',
    head: named('User'),
    width: 80,
    sort: 'owner',
    cell: (run) => (
      <span className={clsx(layout.cut, 'sec')} title={run.owner}>
        {run.owner}
      </span>
    ),
  },
]

/** In the list of removed runs, always. */
export const REMOVAL: Column = {
  key: 'removal',
  name: 'Removed',
  head: named('Removed'),
  width: 330,
  cell: (run, { now }) => <Removal run={run} now={now} />,
}
