// The table of runs with its sorting, its keys (j, k, Enter) and the loading of further pages.
import { useNavigate } from '@tanstack/react-router'
import { type ReactNode, useEffect, useRef, useState } from 'react'
import type { RunSummary } from '../client'
import { Sign } from '../ui/Sign'
import { useHotkeys } from '../ui/useHotkeys'
import { useNow } from '../ui/useNow'
import { RunRow } from './RunRow'
import type { Sort, SortKey } from './search'

interface RunTableProps {
  runs: RunSummary[]
  sort: Sort
  onSort: (sort: Sort) => void
  onTag: (tag: string) => void
  more: (() => void) | null
  loading: boolean
}

export function RunTable({ runs, sort, onSort, onTag, more, loading }: RunTableProps) {
  const now = useNow(10_000)
  const navigate = useNavigate()
  const [chosen, setChosen] = useState(-1)
  const move = (by: number) => setChosen((at) => Math.min(runs.length - 1, Math.max(0, at + by)))
  const open = () => {
    const run = runs[chosen]
    if (run) void navigate({ to: '/runs/$id', params: { id: run.id } })
  }
  useHotkeys({ j: () => move(1), k: () => move(-1), Enter: open })
  const units = new Set(runs.map((run) => `${run.quantity} ${run.unit}`))
  const one = units.size === 1 ? runs[0] : undefined
  const head = { sort, onSort }
  return (
    <>
      <div className="card scrollx">
        <table className="runs">
          <thead>
            <tr>
              <Head {...head} by="name">
                Run
              </Head>
              <Head {...head} by="verdict">
                Verdict
              </Head>
              <Head {...head} by="worst" num unit={one?.unit}>
                Worst {one?.quantity ? <Sign text={one.quantity} /> : 'value'}
              </Head>
              <th className="num">
                Criterion
                {one && <Unit text={one.unit} />}
              </th>
              <Head {...head} by="margin" num unit={one?.unit}>
                Margin
              </Head>
              <th aria-label="Margin bar" />
              <th>Found by</th>
              <Head {...head} by="evaluations" num>
                Evaluations
              </Head>
              <th>Tags</th>
              <th className="num hide-n">Duration</th>
              <Head {...head} by="created" first="-">
                Submitted
              </Head>
            </tr>
          </thead>
          <tbody>
            {runs.map((run, i) => (
              <RunRow key={run.id} run={run} chosen={i === chosen} units={!one} now={now} onTag={onTag} />
            ))}
          </tbody>
        </table>
      </div>
      <p className="small mut" style={{ marginTop: 10 }}>
        Margin bars span ±30 % of the criterion. A search can miss a worse case: open a run for what its verdict rests
        on.
      </p>
      {more && <More load={more} loading={loading} />}
    </>
  )
}

const Unit = ({ text }: { text: string }) => (
  <>
    <br />
    <span className="u">{text}</span>
  </>
)

interface HeadProps {
  by: SortKey
  sort: Sort
  onSort: (sort: Sort) => void
  num?: boolean
  unit?: string
  first?: '-' | ''
  children: ReactNode
}

function Head({ by, sort, onSort, num, unit, first = '', children }: HeadProps) {
  const active = sort === by || sort === `-${by}`
  const down = sort === `-${by}`
  const next: Sort = active ? (down ? by : `-${by}`) : `${first}${by}`
  return (
    <th className={num ? 'num' : undefined} aria-sort={active ? (down ? 'descending' : 'ascending') : undefined}>
      <button type="button" className={active ? 'sorter on' : 'sorter'} onClick={() => onSort(next)}>
        {children}
        {unit !== undefined ? <Unit text={unit} /> : null}
        {active && <span aria-hidden> {down ? '↓' : '↑'}</span>}
      </button>
    </th>
  )
}

/** Loads the next page when it comes into view; a button does the same. */
function More({ load, loading }: { load: () => void; loading: boolean }) {
  const button = useRef<HTMLButtonElement>(null)
  useEffect(() => {
    const element = button.current
    if (!element || loading) return
    const observer = new IntersectionObserver(([entry]) => entry?.isIntersecting && load(), { rootMargin: '300px' })
    observer.observe(element)
    return () => observer.disconnect()
  }, [load, loading])
  return (
    <div style={{ textAlign: 'center', marginTop: 8 }}>
      <button ref={button} type="button" className="btn" onClick={load} disabled={loading}>
        {loading ? 'Loading …' : 'Load more'}
      </button>
    </div>
  )
}
