// The table of runs: sorting, keys (j, k, x, Enter), the rows near the window, and further pages as it scrolls.
import { useNavigate } from '@tanstack/react-router'
import { clsx } from 'clsx'
import { type ReactNode, useEffect, useMemo, useRef, useState } from 'react'
import type { RunSummary } from '../client'
import { useHotkeys } from '../ui/useHotkeys'
import { useNow } from '../ui/useNow'
import { useWidth } from '../ui/useWidth'
import { columnsOf, type Common, REMOVAL, type Sort, type SortKey } from './columns'
import { RunRow } from './RunRow'
import { useRows } from './useRows'
import { cards, fields, layout, tables } from '../ui/styles'
import styles from './runs.module.css'

const ROW = 46
const [MARK, NAME] = [42, 190]
/** Where the list scrolls, so that the longest verdict next to the name is whole in a window of 390 px. */
const SHORT = 172

interface RunTableProps {
  runs: RunSummary[]
  /** Total number of runs, loaded or not. */
  total: number
  cols: string[] | undefined
  sort: Sort
  onSort: (sort: Sort) => void
  /** These three stay the same between renderings, so that only rows that changed are rendered. */
  onTag: (tag: string) => void
  onLabel: (label: string) => void
  onMark: (ids: readonly string[], on: boolean) => void
  marked: ReadonlySet<string>
  /** Whether the list shows removed runs. */
  removed: boolean
  more: (() => void) | null
  loading: boolean
}

export function RunTable({ runs, total, cols, sort, onSort, onTag, onLabel, marked, onMark, removed, more, loading }: RunTableProps) {
  const now = useNow(10_000)
  const [holder, width] = useWidth(1392)
  const body = useRef<HTMLTableSectionElement>(null)
  const { first, end, reveal } = useRows(body, ROW, runs.length)
  const [chosen, setChosen] = useKeys(runs, reveal, marked, onMark)
  const columns = useMemo(() => [...columnsOf(cols, removed, width), ...(removed ? [REMOVAL] : [])], [cols, width, removed])
  const common = commonOf(runs)
  const others = columns.reduce((sum, column) => sum + column.width, MARK)
  const least = others + (others + NAME > width ? SHORT : NAME)

  useEffect(() => {
    if (more && !loading && end > runs.length - 30) more()
  }, [more, loading, end, runs.length])

  return (
    <div ref={holder}>
      <div className={clsx(cards.card, least > width ? layout.scrollx : styles.clip)}>
        <table className={clsx(tables.table, styles.runs)} aria-rowcount={total + 1} style={{ minWidth: least }} onMouseDown={() => setChosen(-1)}>
          <colgroup>
            <col style={{ width: MARK }} />
            <col />
            {columns.map((column) => (
              <col key={column.key} style={{ width: column.width }} />
            ))}
          </colgroup>
          <thead>
            <tr aria-rowindex={1}>
              <th className={styles.mark}>
                <MarkAll runs={runs} marked={marked} onMark={onMark} />
              </th>
              <Head sort={sort} onSort={onSort} by="name">
                Run
              </Head>
              {columns.map((column) => (
                <Head
                  key={column.key}
                  sort={sort}
                  onSort={onSort}
                  by={column.sort}
                  down={column.down}
                  num={column.num}
                  inset={column.inset}
                  under={column.under(common)}
                >
                  {column.head(common)}
                </Head>
              ))}
            </tr>
          </thead>
          <tbody ref={body}>
            <Space rows={first} />
            {runs.slice(first, end).map((run, i) => (
              <RunRow
                key={run.id}
                run={run}
                columns={columns}
                number={first + i + 2}
                chosen={first + i === chosen}
                marked={marked.has(run.id)}
                units={common.unit === undefined}
                now={now}
                onTag={onTag}
                onLabel={onLabel}
                onMark={onMark}
              />
            ))}
            <Space rows={runs.length - Math.min(end, runs.length)} />
          </tbody>
        </table>
      </div>
      <p className="small mut" style={{ marginTop: 10 }} role="status">
        {loading ? 'Loading further runs … ' : ''}
        Margin bars span ±30 % of the criterion. A search can miss a worse case: the page of a run shows the evidence behind
        its verdict.
      </p>
    </div>
  )
}

/** The row selected by keyboard, and the key bindings. */
function useKeys(
  runs: RunSummary[],
  reveal: (index: number) => void,
  marked: ReadonlySet<string>,
  onMark: (ids: readonly string[], on: boolean) => void,
): [number, (index: number) => void] {
  const navigate = useNavigate()
  const [chosen, setChosen] = useState(-1)
  const move = (by: number) => {
    const next = Math.min(runs.length - 1, Math.max(0, chosen + by))
    setChosen(next)
    reveal(next)
    if (document.activeElement instanceof HTMLElement) document.activeElement.blur() // Enter is for the row then
  }
  const run = runs[chosen]
  useHotkeys({
    j: () => move(1),
    k: () => move(-1),
    x: run && (() => onMark([run.id], !marked.has(run.id))),
    Enter: run && (() => void navigate({ to: '/runs/$id', params: { id: run.id } })),
  })
  return [chosen, setChosen]
}

function commonOf(runs: RunSummary[]): Common {
  const quantities = new Set(runs.map((run) => run.quantity))
  const units = new Set(runs.map((run) => run.unit))
  return { quantity: quantities.size === 1 ? (runs[0]?.quantity ?? '') : '', unit: units.size === 1 ? runs[0]?.unit : undefined }
}

const Space = ({ rows }: { rows: number }) =>
  rows > 0 ? (
    <tr aria-hidden="true" className={styles.space}>
      <td style={{ height: rows * ROW }} />
    </tr>
  ) : null

function MarkAll({ runs, marked, onMark }: Pick<RunTableProps, 'runs' | 'marked' | 'onMark'>) {
  const all = runs.length > 0 && runs.every((run) => marked.has(run.id))
  return (
    <label>
      <input
        className={fields.check}
        type="checkbox"
        checked={all}
        aria-label="Select all loaded runs"
        onChange={() =>
          onMark(
            runs.map((run) => run.id),
            !all,
          )
        }
      />
    </label>
  )
}

interface HeadProps {
  by: SortKey | undefined
  sort: Sort
  onSort: (sort: Sort) => void
  num?: boolean
  inset?: number
  down?: boolean
  under?: ReactNode
  children: ReactNode
}

function Head({ by, sort, onSort, num, inset, down: first, under, children }: HeadProps) {
  const lines = (
    <>
      {children}
      {under ? (
        <>
          <br />
          <span className={tables.u}>{under}</span>
        </>
      ) : null}
    </>
  )
  if (!by) return <th className={num ? 'num' : undefined}>{lines}</th>
  const active = sort === by || sort === `-${by}`
  const down = sort === `-${by}`
  const next: Sort = active ? (down ? by : `-${by}`) : first ? `-${by}` : by
  return (
    <th
      className={num ? 'num' : undefined}
      style={inset === undefined ? undefined : { paddingRight: inset }}
      aria-sort={active ? (down ? 'descending' : 'ascending') : undefined}
    >
      <button type="button" className={active ? clsx(styles.sorter, styles.on) : styles.sorter} onClick={() => onSort(next)}>
        {lines}
        {active && <span aria-hidden> {down ? '↓' : '↑'}</span>}
      </button>
    </th>
  )
}
