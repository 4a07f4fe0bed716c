// The columns of the run list: all that the pages know of a column is its entry in `TABLE`.
import { clsx } from 'clsx'
import { IconAlertTriangle } from '@tabler/icons-react'
import type { ReactNode } from 'react'
import type { RunSummary } from '../client'
import { conditionsOf, unknownOf, withoutValue } from '../format/counts'
import { atMost, count, decimalsFor, duration, exact, margin, NONE } from '../format/numbers'
import { launchedBy } from '../format/people'
import { MarginBar } from '../ui/bars'
import { MethodName } from '../ui/MethodMark'
import { Sign } from '../ui/Sign'
import { RunBadge, shownAs } from '../ui/VerdictBadge'
import { amount, type CellContext, Removal, Time } from './cells'
import { Spark } from './Spark'
import { badges, layout, tables } from '../ui/styles'
import styles from './runs.module.css'

/** Common properties of the rows, for the headers. */
export interface Common {
  quantity: string
  /** Undefined if rows differ. */
  unit: string | undefined
}

type Cell = (run: RunSummary, context: CellContext) => ReactNode

interface Declared {
  /** In the menu of columns. */
  name: string
  /** The header where it differs, and its second line. */
  head?: string | ((common: Common) => ReactNode)
  under?: string | ((common: Common) => ReactNode)
  /** [px] */
  width: number
  /** The server's name of the order. */
  sort?: string
  /** Sorted downwards at first, and the order of the list by default. */
  down?: boolean
  first?: boolean
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
  cell: Cell
  /** Shown next to the run's number where the column is not. */
  aside?: (run: RunSummary) => string | false
}

const unitOf = ({ unit }: Common): string => unit ?? ''
const time = (of: (run: RunSummary) => number | null): Cell => (run, { now }) => (
  <span className="sec nw"><Time at={of(run)} now={now} /></span>
)

/** In their order; those of a result are adjacent, because rows without one span them. */
const TABLE = {
  verdict: { name: 'Verdict', width: 130, sort: 'verdict', usual: true, removed: true, cell: (run) => <RunBadge run={run} /> },
  worst: {
    name: 'Worst value', width: 80, sort: 'worst', num: true, result: true, usual: true, removed: true,
    head: ({ quantity }) => <>Worst {quantity ? <Sign text={quantity} /> : 'value'}</>,
    under: unitOf,
    cell: (run, context) => <span className="m">{amount(run.worst_cost, run, context)}</span>,
  },
  nominal: {
    name: 'Nominal value', head: 'Nominal', under: unitOf, width: 84, sort: 'nominal', num: true, result: true,
    cell: (run, context) => <span className="sec">{amount(run.nominal_cost, run, context)}</span>,
  },
  criterion: {
    name: 'Criterion', under: unitOf, width: 70, sort: 'criterion', num: true, result: true, usual: true,
    cell: (run, { units }) => (
      <span className="sec">
        {exact(run.threshold)}
        {units && run.unit ? ` ${run.unit}` : ''}
      </span>
    ),
  },
  margin: {
    name: 'Margin', under: unitOf, width: 136, inset: 67, sort: 'margin', num: true, result: true, usual: true, removed: true,
    cell: (run, context) => <Margin run={run} context={context} />,
  },
  method: {
    name: 'Found by', width: 100, sort: 'method', result: true, usual: true, wide: 1226,
    cell: (run) => run.worst_method ? <MethodName method={run.worst_method} short /> : <span className="mut">{NONE}</span>,
  },
  bound: {
    name: 'P(violation) bound', head: 'P(violation)', under: 'upper bound', width: 92, sort: 'bound', num: true, result: true,
    usual: true,
    cell: (run) =>
      run.upper_bound === null ? (
        <span className="mut">not sampled</span>
      ) : (
        <span className="sec">
          ≤ {atMost(run.upper_bound)}
          {conditionsOf(run) && <div className="mut small">{conditionsOf(run)}</div>}
        </span>
      ),
  },
  evaluations: {
    name: 'Evaluations', width: 92, sort: 'evaluations', down: true, num: true, result: true,
    cell: (run) => <span className="sec" title={withoutValue(run)}>{count(run.evaluations)}</span>,
  },
  failed: {
    name: 'Failed evaluations', head: 'Failed', under: 'evaluations', width: 84, sort: 'failed', down: true, num: true,
    result: true, cell: (run) => lost(run.failed_evaluations),
  },
  excluded: {
    name: 'Excluded evaluations', head: 'Excluded', under: 'evaluations', width: 84, num: true, result: true,
    cell: (run) => lost(run.excluded_evaluations),
  },
  course: {
    name: 'Best of searches', under: 'evaluations, log', width: 116, usual: true,
    cell: (run) => (
      <Spark
        course={run.best_so_far}
        evaluations={run.evaluations}
        threshold={run.threshold}
        violated={run.margin !== null && run.margin <= 0}
      />
    ),
  },
  campaign: {
    name: 'Campaign', width: 190, sort: 'campaign',
    cell: (run) => <span className={clsx(layout.cut, 'sec')} title={run.campaign_name}>{run.campaign_name}</span>,
    aside: (run) => run.campaign_name !== run.name && run.campaign_name,
  },
  tags: {
    name: 'Tags', width: 176, sort: 'tags', usual: true, removed: true, wide: 1226,
    cell: (run, { onTag, onLabel }) => (
      <Words
        all={[
          ...run.tags.map((tag) => ({ text: tag, title: `Show runs tagged ${tag}`, show: () => onTag(tag) })),
          ...Object.entries(run.labels).map(([key, value]) => {
            const text = `${key}=${value}`
            return { text, title: `Show runs with the label ${text}`, show: () => onLabel(text) }
          }),
        ]}
      />
    ),
  },
  duration: {
    name: 'Duration', width: 80, sort: 'duration', down: true, num: true, usual: true, wide: 1300,
    cell: (run, { now }) => (
      <span className="sec">{run.started ? duration((run.finished ?? now) - run.started) : NONE}</span>
    ),
  },
  submitted: {
    name: 'Submitted', width: 94, sort: 'created', down: true, first: true, usual: true, removed: true,
    cell: time((run) => run.created),
  },
  started: { name: 'Started', width: 100, sort: 'started', down: true, cell: time((run) => run.started) },
  finished: { name: 'Finished', width: 100, sort: 'finished', down: true, cell: time((run) => run.finished) },
  owner: {
    name: 'User', width: 80, sort: 'owner', usual: true, wide: 1300,
    cell: (run) => (
      <span className={tables.rn} title={launchedBy(run)}>
        <span className={clsx(layout.cut, 'sec')}>{run.owner}</span>
        {run.token !== null && <small className={layout.cut}>token {run.token}</small>}
      </span>
    ),
  },
} as const satisfies Record<string, Declared>

type Table = typeof TABLE
export type ColumnKey = keyof Table
export type SortKey = Extract<Table[ColumnKey], { sort: string }>['sort'] | 'name'
export type Sort = SortKey | `-${SortKey}`

export interface Column extends Omit<Declared, 'sort' | 'head' | 'under'> {
  key: ColumnKey | 'removal'
  sort?: SortKey
  head: (common: Common) => ReactNode
  under: (common: Common) => ReactNode
}

const DECLARED: Readonly<Record<ColumnKey, Declared & { sort?: SortKey }>> = TABLE
const written = (text: Declared['head']): Column['head'] => (typeof text === 'function' ? text : () => text)

export const COLUMNS: readonly Column[] = (Object.keys(TABLE) as ColumnKey[]).map((key) => {
  const { head, under, ...declared } = DECLARED[key]
  return { ...declared, key, head: written(head ?? declared.name), under: written(under) }
})

/** In the list of removed runs, always. */
export const REMOVAL: Column = {
  key: 'removal',
  name: 'Removed',
  head: () => 'Removed',
  under: () => null,
  width: 330,
  cell: (run, { now }) => <Removal run={run} now={now} />,
}

/** The orders; a run's name is in every list. */
const SORTS: readonly Sort[] = ['name' as const, ...COLUMNS.flatMap(({ sort }) => sort ?? [])].flatMap((key) => [key, `-${key}` as const])
const FIRST: Sort = `-${COLUMNS.find(({ first }) => first)?.sort ?? 'name'}`

/** The order that an address states, by default that of the list. */
export const sortOf = (stated: string | undefined): Sort => SORTS.find((sort) => sort === stated) ?? FIRST

/** What an address states of an order. */
export const statedOf = (sort: Sort): Sort | undefined => (sort === FIRST ? undefined : sort)

/** The columns that an address states, in their order; by default those of a list of this width. */
export const columnsOf = (stated: readonly string[] | undefined, removed: boolean, width = Infinity): readonly Column[] =>
  COLUMNS.filter(({ key, removed: kept, usual, wide = 0 }) => (stated ? stated.includes(key) : removed ? kept : usual && width >= wide))

const lost = (evaluations: number): ReactNode => <span className={evaluations ? 'b' : 'sec'}>{count(evaluations)}</span>

function Margin({ run, context }: { run: RunSummary; context: CellContext }) {
  const violated = run.margin !== null && run.margin <= 0
  const unit = context.units && run.unit ? ` ${run.unit}` : ''
  return (
    <span className={clsx(layout.row, styles.marg)}>
      <span className={violated ? 'b bad-t' : 'm'} title={unknownOf(run) || undefined}>
        {unknownOf(run) && (
          <>
            <IconAlertTriangle className="i s unk-t" aria-label={unknownOf(run)} />{' '}
          </>
        )}
        {margin(run.margin, decimalsFor([run.worst_cost, run.threshold]))}
        {unit}
      </span>
      {run.margin !== null && run.threshold ? (
        <MarginBar margin={run.margin} threshold={run.threshold} cleared={shownAs(run) === 'cleared'} />
      ) : (
        <span style={{ width: 50 }} />
      )}
    </span>
  )
}

/** Tags and labels of a run as words; what a click on one shows. */
type Word = { text: string; title: string; show: () => void }

/** Those that fit into the column, at least one; widths are estimated from the number of letters. */
function fitting(all: readonly Word[]): readonly Word[] {
  const within = (room: number) => all.findIndex(({ text }) => (room -= text.length + 3) < 0)
  // Where some are left out, their number needs room, too.
  return within(26) < 0 ? all : all.slice(0, Math.max(1, within(22)))
}

function Words({ all }: { all: readonly Word[] }) {
  const shown = fitting(all)
  const more = all.slice(shown.length).map(({ text }) => text)
  return (
    <span className={layout.cut}>
      {shown.map(({ text, title, show }) => (
        <button key={text} type="button" className={clsx(badges.tag, styles.tag)} onClick={show} title={title}>
          {text}
        </button>
      ))}
      {more.length > 0 && (
        <span className="small mut" title={more.join(', ')}>
          {' '}
          +{more.length}
          <span className="sr"> more: {more.join(', ')}</span>
        </span>
      )}
    </span>
  )
}
