// The runs of a campaign in time: verdicts, worst margins, bounds, and where the code changed.
import { queryOptions, useQuery } from '@tanstack/react-query'
import { Link, useNavigate, useSearch } from '@tanstack/react-router'
import { clsx } from 'clsx'
import { useMemo } from 'react'
import { getTrend } from '../api/calls'
import { facetsQuery } from '../api/queries'
import { ChartCard } from '../charts/ChartCard'
import { OutcomesChart } from '../charts/OutcomesChart'
import type { Trend, TrendRun } from '../client'
import { count } from '../format/numbers'
import { rfc3339 } from '../format/time'
import { PageHead } from '../page/PageHead'
import { Loading, Trouble } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { Card, Seg } from '../ui/Card'
import { FilterMenu } from '../ui/FilterMenu'
import { usePolling } from '../ui/usePolling'
import { type Along, apart, axisOf } from './axis'
import { boundOf, CodeCell, DateCell, marginOf, OutcomeBadge, RunCell } from './cells'
import type { TrendSearch } from './search'
import { changesOf } from './changes'
import buttons from '../ui/buttons.module.css'
import layout from '../ui/layout.module.css'
import tables from '../ui/tables.module.css'
import styles from './trends.module.css'

const trendQuery = ({ campaign, name, label }: TrendSearch) =>
  queryOptions({
    queryKey: ['trend', campaign, name, label],
    queryFn: () => getTrend({ campaign, name, label }),
    // While other labels are chosen the page stays, and with it the menu.
    placeholderData: (before: Trend | undefined, query) =>
      query?.queryKey[1] === campaign && query?.queryKey[2] === name ? before : undefined,
    enabled: Boolean(campaign ?? name),
  })

export function TrendsPage() {
  const search = useSearch({ from: '/trends' })
  const query = useQuery(trendQuery(search))
  useTitle(query.data ? `Trend of ${query.data.name}` : 'Trends')
  usePolling(() => void query.refetch(), 5000, query.data?.runs.some((run) => ['queued', 'running', 'cancelling'].includes(run.state)) ?? false)
  if (!search.campaign && !search.name) return <Campaigns />
  if (query.isError && !query.data) return <Trouble error={query.error} retry={() => void query.refetch()} />
  if (!query.data) return <Loading what="the trend" title="Trends" failed={query.failureReason} />
  return <Shown trend={query.data} />
}

/** Without a campaign in the address: a choice of those that have runs. */
function Campaigns() {
  const { data, error, failureReason, refetch } = useQuery(facetsQuery)
  if (error && !data) return <Trouble error={error} retry={() => void refetch()} />
  if (!data) return <Loading what="the campaigns" title="Trends" failed={failureReason} />
  return (
    <>
      <PageHead title="Trends" />
      <Card title="Campaigns" note={data.campaigns.length > 0 && "By name, those with the most runs first"} flush={data.campaigns.length > 0}>
        {data.campaigns.length === 0 && (
          <p className="sec">
            There are no runs yet. <Link to="/launch">Launch one</Link>.
          </p>
        )}
        {data.campaigns.length > 0 && (
          <table className={tables.table}>
            <thead>
              <tr>
                <th>Campaign</th>
                <th className="num">Runs</th>
              </tr>
            </thead>
            <tbody>
              {data.campaigns.map(({ value, runs }) => (
                <tr key={value}>
                  <td>
                    <Link to="/trends" search={{ name: value }}>
                      {value}
                    </Link>
                  </td>
                  <td className="num">{count(runs)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        )}
      </Card>
    </>
  )
}

function Shown({ trend }: { trend: Trend }) {
  const { runs, total } = trend
  const search = useSearch({ from: '/trends' })
  const navigate = useNavigate()
  const usual: Along = apart(runs) ? 'time' : 'order'
  const along = search.along ?? usual
  const { points, axis } = useMemo(() => axisOf(runs, along), [runs, along])
  const show = (next: Along) =>
    void navigate({ to: '/trends', search: { ...search, along: next === usual ? undefined : next }, replace: true })
  const narrow = (label: string[] | undefined) => void navigate({ to: '/trends', search: { ...search, label }, replace: true })
  const data = () => ({
    name: 'trend',
    columns: ['run', 'submitted', 'finished', 'state', 'verdict', 'seed', 'worst margin', 'unit', 'P(violation) upper bound', 'confidence', 'campaign', 'code', 'requirements', 'labels'],
    rows: runs.map((run) => [
      run.id, rfc3339(run.created), run.finished === null ? null : rfc3339(run.finished), run.state, run.verdict, run.seed,
      run.margin, run.unit, run.upper_bound, run.confidence, run.campaign_digest, run.code, run.requirements.join('; '),
      Object.entries(run.labels).map(([key, value]) => `${key}=${value}`).join('; '),
    ]),
  })
  return (
    <>
      <div className={layout.ph}>
        <div className={layout.t}>
          <h1>{trend.name}</h1>
          <p className="sec">
            {trend.digest ? (
              <>
                Runs of one campaign, sha256{' '}
                <span className="mono" title={trend.digest}>
                  {trend.digest.slice(0, 16)}
                </span>
              </>
            ) : (
              `Runs of ${count(trend.campaigns)} ${trend.campaigns === 1 ? 'campaign' : 'campaigns'} of this name`
            )}
          </p>
        </div>
        <div className={layout.acts}>
          {trend.digest && (
            <Link to="/trends" search={{ name: trend.name, label: search.label }} className={buttons.btn}>
              All campaigns of this name
            </Link>
          )}
          {(trend.labels.length > 0 || search.label) && (
            <FilterMenu name="Label" options={trend.labels} value={search.label} onChange={narrow} />
          )}
        </div>
      </div>
      {runs.length === 0 ? (
        <p className="sec">{search.label ? 'No run of this campaign has the chosen labels.' : 'No run has this campaign.'}</p>
      ) : (
        <div className={layout.grid}>
          <ChartCard title={`Worst margin and P(violation) ${along === 'time' ? 'over time' : 'by run'}`} note={changesOf(runs)} className={layout.c12} run="trend" data={data} right={<AlongSeg value={along} onChange={show} />}>
            <OutcomesChart points={points} axis={axis} sync="trend" name={({ run }) => run} />
          </ChartCard>
          <Card
            title="Runs"
            note="The newest first"
            className={layout.c12}
            flush
            footer={total > runs.length && `The newest ${runs.length} of ${count(total)} runs.`}
          >
            <Table runs={runs} named={!trend.digest} label={search.label} />
          </Card>
        </div>
      )}
    </>
  )
}

function AlongSeg({ value, onChange }: { value: Along; onChange: (value: Along) => void }) {
  return (
    <Seg
      label="Horizontal axis"
      options={[
        { value: 'time', label: 'Time' },
        { value: 'order', label: 'Order' },
      ]}
      value={value}
      onChange={onChange}
    />
  )
}

function Table({ runs, named, label }: { runs: readonly TrendRun[]; named: boolean; label: string[] | undefined }) {
  const stated = runs.some(({ requirements }) => requirements.length > 0)
  const labelled = runs.some(({ labels }) => Object.keys(labels).length > 0)
  return (
    <table className={tables.table}>
      <thead>
        <tr>
          <th className="num">No.</th>
          <th>Verdict</th>
          <th>Run</th>
          <th className="num">Worst margin</th>
          <th className="num">P(violation)</th>
          {named && <th>Campaign</th>}
          <th className="num">Seed</th>
          <th>Code</th>
          {stated && <th>Evidence for</th>}
          {labelled && <th>Labels</th>}
          <th>Finished</th>
        </tr>
      </thead>
      <tbody>
        {runs.map((run, i) => (
          <tr key={run.id} className={clsx(runs[i + 1]?.code_changed && styles.changed)}>
            <td className="num sec">{i + 1}</td>
            <td>
              <OutcomeBadge outcome={run} />
            </td>
            <td>
              <RunCell run={run.id} name={run.name} />
            </td>
            <td className="num">{marginOf(run)}</td>
            <td className="num sec">{boundOf(run)}</td>
            {named && (
              <td className="sec">
                <Link to="/trends" search={{ campaign: run.campaign_digest, label }} className="mono" title={run.campaign_digest}>
                  {run.campaign_digest.slice(0, 8)}
                </Link>
                {run.campaign_changed && ' changed'}
              </td>
            )}
            <td className="num sec">{run.seed}</td>
            <td className="nw">
              <CodeCell code={run.code} />
              {run.code_changed && <span className="b"> changed</span>}
            </td>
            {stated && (
              <td className="sec">
                {run.requirements.map((id, at) => (
                  <span key={id}>
                    {at > 0 && ', '}
                    <Link to="/requirements" search={{ q: id }}>
                      {id}
                    </Link>
                  </span>
                ))}
              </td>
            )}
            {labelled && (
              <td className="sec">
                {Object.entries(run.labels)
                  .map(([key, value]) => `${key}=${value}`)
                  .join(', ')}
              </td>
            )}
            <td>
              <DateCell outcome={run} />
            </td>
          </tr>
        )).reverse()}
      </tbody>
    </table>
  )
}
