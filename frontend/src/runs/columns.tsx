// The columns of the run list: names, widths, sort orders and cells.
import { clsx } from 'clsx'
import type { ReactNode } from 'react'
import type { RunSummary } from '../client'
import { sourceOf, withoutValue } from '../format/counts'
import { atMost, count, duration, exact, NONE } from '../format/numbers'
import { launchedBy } from '../format/people'
import { MethodName } from '../ui/MethodMark'
import { Sign } from '../ui/Sign'
import { RunBadge } from '../ui/VerdictBadge'
import { amount, Margin, Removal, Tags, Time } from './cells'
import { COLUMN_KEYS, type ColumnKey, DECLARED, type Declared, type SortKey } from './columnKeys'
import { Spark } from './Spark'
import { layout, tables } from '../ui/styles'

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

export interface Column extends Pick<Declared, 'name' | 'width' | 'down' | 'num' | 'inset' | 'result'> {
  key: ColumnKey | 'removal'
  head: (common: Common) => ReactNode
  /** Second line of the header. */
  under?: (common: Common) => ReactNode
  sort?: SortKey
  cell: (run: RunSummary, context: CellContext) => ReactNode
}

const unitOf = ({ unit }: Common): string => unit ?? ''

/** The cells that need more than one field, and the headers that name the criterion or its unit. */
const CELLS: Partial<Record<ColumnKey, Pick<Column, 'cell' | 'under'> & { head?: Column['head'] }>> = {
  verdict: { cell: (run) => <RunBadge run={run} /> },
  worst: {
    head: ({ quantity }) => <>Worst {quantity ? <Sign text={quantity} /> : 'value'}</>,
    under: unitOf,
    cell: (run, context) => <span className="m">{amount(run.worst_cost, run, context)}</span>,
  },
  nominal: { under: unitOf, cell: (run, context) => <span className="sec">{amount(run.nominal_cost, run, context)}</span> },
  criterion: {
    under: unitOf,
    cell: (run, { units }) => (
      <span className="sec">
        {exact(run.threshold)}
        {units && run.unit ? ` ${run.unit}` : ''}
      </span>
    ),
  },
  margin: { under: unitOf, cell: (run, context) => <Margin run={run} context={context} /> },
  method: {
    cell: (run) =>
      run.worst_method ? <MethodName method={run.worst_method} short /> : <span className="mut">{NONE}</span>,
  },
  bound: {
    cell: (run) =>
      run.upper_bound === null ? (
        <span className="mut">not sampled</span>
      ) : (
        <span className="sec">
          ≤ {atMost(run.upper_bound)}
          {sourceOf(run.bound_source) && <div className="mut small">{sourceOf(run.bound_source)}</div>}
        </span>
      ),
  },
  evaluations: {
    cell: (run) => (
      <span className="sec" title={withoutValue(run)}>
        {count(run.evaluations)}
      </span>
    ),
  },
  course: {
    cell: (run) => (
      <Spark
        course={run.best_so_far}
        evaluations={run.evaluations}
        threshold={run.threshold}
        violated={run.margin !== null && run.margin <= 0}
      />
    ),
  },
  tags: { cell: (run, { onTag, onLabel }) => <Tags run={run} onTag={onTag} onLabel={onLabel} /> },
  owner: {
    cell: (run) => (
      <span className={tables.rn} title={launchedBy(run)}>
        <span className={clsx(layout.cut, 'sec')}>{run.owner}</span>
        {run.token !== null && <small className={layout.cut}>token {run.token}</small>}
      </span>
    ),
  },
  duration: {
    cell: (run, { now }) => (
      <span className="sec">{run.started ? duration((run.finished ?? now) - run.started) : NONE}</span>
    ),
  },
}

/** The cell of one field, by its kind. */
function plain(key: ColumnKey): Column['cell'] {
  const { field, kind } = DECLARED[key]
  return (run, { now }) => {
    const value = field === undefined ? null : run[field]
    if (kind === 'count') return <span className={value ? 'b' : 'sec'}>{count(Number(value))}</span>
    if (kind === 'time') return <span className="sec nw"><Time at={value as number | null} now={now} /></span>
    const text = typeof value === 'string' || typeof value === 'number' ? String(value) : NONE
    return (
      <span className={clsx(layout.cut, 'sec')} title={text}>
        {text}
      </span>
    )
  }
}

export const COLUMNS: readonly (Column & { key: ColumnKey })[] = COLUMN_KEYS.map((key) => {
  const { name, head = name, under, width, sort, down, num, inset, result } = DECLARED[key]
  return {
    key, name, width, sort, down, num, inset, result,
    head: () => head, under: under === undefined ? undefined : () => under, cell: plain(key), ...CELLS[key],
  }
})

/** In the list of removed runs, always. */
export const REMOVAL: Column = {
  key: 'removal',
  name: 'Removed',
  head: () => 'Removed',
  width: 330,
  cell: (run, { now }) => <Removal run={run} now={now} />,
}
