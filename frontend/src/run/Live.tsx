// An active run: figures, stages, convergence, best so far, methods, improvements.
import { IconAlertTriangle, IconLoader } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { useStill } from '../api/still'
import type { RunDetail, StageProgress } from '../client'
import { unknownOf, withoutValue } from '../format/counts'
import { age } from '../format/time'
import { count, decimalsApart, decimalsBeside, duration, exact, fixed, margin as marginText, NONE } from '../format/numbers'
import { Card, Stat } from '../ui/Card'
import { MethodName } from '../ui/MethodMark'
import { methodLook } from '../ui/methods'
import { Sign } from '../ui/Sign'
import { Table } from '../ui/Table'
import { useNow } from '../ui/useNow'
import { Convergence } from './search/Convergence'
import { bestOf, hasSpace, leaderOf, type RunData, searchesOf } from './data/data'
import { insteadOf } from './data/missing'
import { Failures } from './search/Failures'
import { MethodsTable } from './search/MethodsTable'
import { Notes } from './header/Notes'
import { OtherCode } from './header/OtherCode'
import { NominalWorst } from './parameters/NominalWorst'
import { StageStrip } from './search/StageStrip'
import { LiveSpace } from './space/SpaceSection'
import { cards, icons, layout } from '../ui/styles'
import styles from './run.module.css'

/** That it stored nothing for long, and what ends that. */
function StandsStill({ run }: { run: string }) {
  const since = useStill(run)
  const now = useNow(10_000)
  if (since === null) return null
  return (
    <p className={cards.note} style={{ marginBottom: 'var(--gap)' }} role="status">
      <IconAlertTriangle className="i bad-t" aria-hidden />
      <span>
        No new evaluation for {age(Math.max(0, now - since))}. The worker replaces a process that has none for much longer than
        before; cancel the run to end it now.
      </span>
    </p>
  )
}

export function Live({ data }: { data: RunData }) {
  const { run } = data
  const best = bestOf(data)
  if (run.state === 'queued') return <Queued data={data} />
  return (
    <>
      {run.doing && (
        <p className={cards.note} style={{ marginBottom: 'var(--gap)' }} role="status">
          <IconLoader className={clsx(icons.spin, 'i')} aria-hidden />
          <span>{run.doing.sentence}</span>
        </p>
      )}
      <StandsStill run={run.id} />
      <Figures data={data} />
      <div style={{ marginTop: 'var(--gap)' }}>
        <StageStrip run={run} />
      </div>
      <div className={layout.grid} style={{ marginTop: 'var(--gap)' }}>
        <div className={clsx(layout.stack, styles.filled, layout.c8)}>
          <Convergence data={data} height={400} />
          <MethodsTable data={data} />
        </div>
        <div className={clsx(layout.stack, styles.pair, layout.c4)}>
          <NominalWorst
            data={data}
            title="Best so far"
            column="Best so far"
            worst={best}
          />
          <Improvements data={data} />
        </div>
        {hasSpace(data) && <LiveSpace data={data} />}
        {/* Shown during the run, because failures may be a reason to cancel it. */}
        {data.evaluations && data.evaluations.failures.length > 0 && <Failures data={data} />}
        <Notes run={run} className={layout.c12} />
      </div>
    </>
  )
}

function Queued({ data }: { data: RunData }) {
  return (
    <>
      <p className={cards.note} style={{ marginBottom: 'var(--gap)' }} role="status">
        This run is waiting. {data.run.waits ?? 'It starts when a worker is free.'}
      </p>
      {data.run.other_code !== null && <OtherCode run={data.run} />}
      <StageStrip run={data.run} />
      <div className={layout.grid} style={{ marginTop: 'var(--gap)' }}>
        <NominalWorst data={data} className={layout.c6} title="Uncertain parameters" column={null} worst={null} />
        <Notes run={data.run} className={layout.c6} />
      </div>
    </>
  )
}

function Figures({ data }: { data: RunData }) {
  const { run } = data
  const now = useNow(1000)
  const leader = leaderOf(run)
  const cost = leader?.best ?? run.worst_cost
  const decimals = decimalsBeside([cost, run.nominal_cost], run.threshold)
  const margin = cost === null || run.threshold === null ? null : cost - run.threshold
  return (
    <div className={cards.card}>
      <div className={styles.stats}>
        <Stat
          name={
            <>
              Best (smallest) <Sign text={run.quantity || 'value'} /> so far
            </>
          }
          value={fixed(cost, decimals)}
          unit={cost === null ? undefined : run.unit}
          note={
            leader
              ? `${leader.method === null ? leader.title : methodLook(leader.method).title}${leader.best_index === null ? '' : `, evaluation ${count(leader.best_index + 1)}`}`
              : 'no value yet'
          }
          testId="best"
        />
        <Stat
          name="Margin to criterion"
          value={marginText(margin, decimals)}
          unit={margin === null ? undefined : run.unit}
          bad={margin !== null && margin <= 0}
          note={
            <>
              {`criterion ${exact(run.threshold)} ${run.unit}${run.nominal_cost === null ? '' : `, nominal ${fixed(run.nominal_cost, decimals)} ${run.unit}`}`}
              {unknownOf(run) && <span className="unk-t">; {unknownOf(run)}</span>}
            </>
          }
        />
        <Stat
          name="Evaluations"
          value={count(run.evaluations)}
          note={`of at most ${count(run.planned)}, ${withoutValue(run)}`}
        />
        <Stat
          name="Evaluations per second"
          value={run.rate === null ? NONE : count(run.rate)}
          note="of the running stage"
        />
        <Stat
          name="Time left"
          value={run.remaining === null ? NONE : duration(run.remaining)}
          note={`if all budgets are used${withoutOf(run)}; ${duration(elapsed(run, now))} elapsed`}
        />
      </div>
    </div>
  )
}

/** What the time left leaves out: stages that compute without evaluations. */
const withoutOf = ({ remaining, untimed }: RunDetail): string =>
  remaining === null || untimed.length === 0 ? '' : `, without ${untimed.join(', ')}`

const elapsed = (run: RunDetail, now: number): number | null =>
  run.started === null ? null : Math.max(0, now - run.started)

/** The last improvements of each method, newest first. */
function Improvements({ data }: { data: RunData }) {
  const rows = newestOf(data)
  return (
    <Card title="Improvements" note="Newest first" flush={rows.length > 0}>
      {rows.length > 0 ? (
        <Newest data={data} rows={rows} />
      ) : (
        <p className="sec">{data.evaluations ? 'No search has found a value yet.' : insteadOf(data.missing, 'evaluations')}</p>
      )}
    </Card>
  )
}

interface Improvement {
  stage: StageProgress
  at: number
  cost: number
}

const newestOf = (data: RunData): Improvement[] =>
  searchesOf(data)
    .flatMap(({ stage, series }) => {
      const { index = [], cost = [] } = series?.improvements ?? {}
      return index
        .map((at, i) => ({ stage, at, cost: cost[i] ?? Number.NaN, before: cost[i - 1] }))
        .filter((row) => row.before === undefined || row.cost < row.before)
        .slice(-7)
    })
    .reverse()
    .slice(0, 9)

function Newest({ data, rows }: { data: RunData; rows: readonly Improvement[] }) {
  const decimals = decimalsApart(
    rows.map((row) => row.cost),
    5,
    8,
  )
  return (
    <Table
      tight
      rows={rows}
      columns={[
        { head: 'Method', cell: ({ stage }) => <MethodName method={stage.method} short /> },
        { head: 'Evaluation', num: true, tone: 'sec', cell: ({ at }) => count(at + 1) },
        { head: <><Sign text={data.run.quantity || 'value'} />, {data.run.unit}</>, num: true, tone: 'm', cell: ({ cost }) => fixed(cost, decimals) },
      ]}
    />
  )
}
