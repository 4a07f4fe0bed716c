// The columns of the run list in their order; those of a result are adjacent, because rows without one span them. A column
// whose cell is a number, a time or a text is declared here alone, others have a cell of their own in `columns.tsx`.
import type { RunSummary } from '../client'

export interface Declared {
  /** In the menu of columns. */
  name: string
  /** The header where it differs, and its second line. */
  head?: string
  under?: string
  /** [px] */
  width: number
  /** The server's name of the order. */
  sort?: string
  /** Sorted downwards at first. */
  down?: boolean
  num?: boolean
  /** Right padding of the header, if the numbers are not at the right edge [px]. */
  inset?: number
  /** Part of a result: a run without one shows its state instead. */
  result?: boolean
  /** Shown by default, and in the list of removed runs, where the reason needs room. */
  usual?: boolean
  removed?: boolean
  /** By default omitted where the list is narrower than this, so that the others are whole [px]. */
  wide?: number
  /** The field of a run that the cell shows, and how. */
  field?: keyof RunSummary
  kind?: 'count' | 'time' | 'text'
}

const TABLE = {
  verdict: { name: 'Verdict', width: 130, sort: 'verdict', usual: true, removed: true },
  worst: { name: 'Worst value', width: 80, sort: 'worst', num: true, result: true, usual: true, removed: true },
  nominal: { name: 'Nominal value', head: 'Nominal', width: 84, sort: 'nominal', num: true, result: true },
  criterion: { name: 'Criterion', width: 70, sort: 'criterion', num: true, result: true, usual: true },
  margin: { name: 'Margin', width: 136, inset: 67, sort: 'margin', num: true, result: true, usual: true, removed: true },
  method: { name: 'Found by', width: 100, sort: 'method', result: true, usual: true, wide: 1226 },
  bound: {
    name: 'P(violation) bound', head: 'P(violation)', under: 'upper bound', width: 92, sort: 'bound', num: true, result: true,
    usual: true,
  },
  evaluations: { name: 'Evaluations', width: 92, sort: 'evaluations', down: true, num: true, result: true },
  failed: {
    name: 'Failed evaluations', head: 'Failed', under: 'evaluations', width: 84, sort: 'failed', down: true, num: true,
    result: true, field: 'failed_evaluations', kind: 'count',
  },
  excluded: {
    name: 'Excluded evaluations', head: 'Excluded', under: 'evaluations', width: 84, num: true, result: true,
    field: 'excluded_evaluations', kind: 'count',
  },
  course: { name: 'Best of searches', under: 'evaluations, log', width: 116, usual: true },
  campaign: { name: 'Campaign', width: 190, sort: 'campaign', field: 'campaign_name', kind: 'text' },
  tags: { name: 'Tags', width: 176, sort: 'tags', usual: true, removed: true, wide: 1226 },
  duration: { name: 'Duration', width: 80, sort: 'duration', down: true, num: true, usual: true, wide: 1300 },
  submitted: {
    name: 'Submitted', width: 94, sort: 'created', down: true, usual: true, removed: true, field: 'created', kind: 'time',
  },
  started: { name: 'Started', width: 100, sort: 'started', down: true, field: 'started', kind: 'time' },
  finished: { name: 'Finished', width: 100, sort: 'finished', down: true, field: 'finished', kind: 'time' },
  owner: { name: 'User', width: 80, sort: 'owner', usual: true, wide: 1300 },
} as const satisfies Record<string, Declared>

export type ColumnKey = keyof typeof TABLE
type Sorted = Extract<(typeof TABLE)[ColumnKey], { sort: string }>
export type SortKey = Sorted['sort'] | 'name'

export const DECLARED: Readonly<Record<ColumnKey, Declared & { sort?: SortKey }>> = TABLE
export const COLUMN_KEYS = Object.keys(TABLE) as ColumnKey[]

const having = (wanted: 'usual' | 'removed' | 'wide' | 'sort') => COLUMN_KEYS.filter((key) => DECLARED[key][wanted])

/** The orders; a run's name is in every list. */
export const SORTS: readonly SortKey[] = ['name', ...having('sort').flatMap((key) => DECLARED[key].sort ?? [])]
export const USUAL: readonly ColumnKey[] = having('usual')
export const USUAL_REMOVED: readonly ColumnKey[] = having('removed')
export const WIDE_ONLY: Partial<Record<ColumnKey, number>> = Object.fromEntries(
  having('wide').map((key) => [key, DECLARED[key].wide]),
)
