// The runs of a campaign in time: verdicts, worst margins, bounds, and where the code changed.
import { queryOptions, useQuery } from '@tanstack/react-query'
import { Link, useNavigate, useSearch } from '@tanstack/react-router'
import { useMemo } from 'react'
import { facetsQuery, isLive } from '../api/queries'
import { ChartCard } from '../charts/ChartCard'
import { OutcomesChart } from '../charts/OutcomesChart'
import { getTrend, type Trend, type TrendRun } from '../client'
import { count } from '../format/numbers'
import { rfc3339 } from '../format/time'
import { PageHead } from '../page/PageHead'
import { Unloaded } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { ButtonLink } from '../ui/Button'
import { Card, Seg } from '../ui/Card'
import { Digest } from '../ui/Digests'
import { FilterMenu } from '../overlay/FilterMenu'
import { Table } from '../ui/Table'
import { usePolling } from '../ui/usePolling'
import { headlineOf } from '../ui/VerdictBadge'
import { type Along, apart, axisOf } from './axis'
import { CodeCell, DateCell, outcomeColumns } from './cells'
import { changesOf, namesOf } from './code'
import type { TrendSearch } from './search'
import { layout } from '../ui/styles'
import styles from './trends.module.css'

const trendQuery = ({ campaign, name, label }: TrendSearch) =>
  queryOptions({
    queryKey: ['trend', campaign, name, label],
    queryFn: () => getTrend({ query: { campaign, name, label } }),
    // While other labels are chosen the page stays, and with it the menu.
    placeholderData: (before: Trend | undefined, query) =>
      query?.queryKey[1] === campaign && query?.queryKey[2] === name ? before : undefined,
    enabled: Boolean(campaign ?? name),
  })

export function TrendsPage() {
  const search = useSearch({ from: '/trends' })
  const query = useQuery(trendQuery(search))
  useTitle(query.data ? `Trend of ${query.data.name}` : 'Trends')
  usePolling(() => query.refetch(), 5000, query.data?.runs.some(isLive) ?? false)
  if (!search.campaign && !search.name) return <Campaigns />
  if (!query.data) return <Unloaded query={query} what="the trend" title="Trends" />
  return <Shown trend={query.data} />
}

/** Without a campaign in the address: a choice of those that have runs. */
function Campaigns() {
  const query = useQuery(facetsQuery)
  if (!query.data) return <Unloaded query={query} what="the campaigns" title="Trends" />
  const { campaigns } = query.data
  return (
    <>
      <PageHead title="Trends" />
      <Card title="Campaigns" note={campaigns.length > 0 && "By name, those with the most runs first"} flush={campaigns.length > 0}>
        {campaigns.length === 0 && (
          <p className="sec">
            There are no runs yet. <Link to="/launch">Launch one</Link>.
          </p>
        )}
        {campaigns.length > 0 && (
          <Table
            rows={campaigns}
            columns={[
              {
                head: 'Campaign',
                cell: ({ value }) => (
                  <Link to="/trends" search={{ name: value }}>
                    {value}
                  </Link>
                ),
              },
              { head: 'Runs', num: true, cell: ({ runs }) => count(runs) },
            ]}
          />
        )}
      </Card>
    </>
  )
}

const ALONG = { time: 'Time', order: 'Order' }

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
    columns: ['run', 'submitted', 'finished', 'state', 'verdict', 'seed', 'worst margin', 'unit', 'P(violation) upper bound', 'bound source', 'confidence', 'campaign', 'code', 'requirements', 'labels', 'policy', 'unconfirmed', 'excluded samples', 'excluded fraction'],
    rows: runs.map((run) => [
      run.id, rfc3339(run.created), run.finished === null ? null : rfc3339(run.finished), run.state, headlineOf({ ...run, policy: null }), run.seed,
      run.margin, run.unit, run.upper_bound, run.bound_source ?? null, run.confidence, run.campaign_digest, run.code, run.requirements.join('; '),
      labelsText(run.labels, '; '), run.policy, run.unconfirmed, run.excluded_samples ?? null, run.excluded_fraction ?? null,
    ]),
  })
  return (
    <>
      <PageHead
        title={trend.name}
        note={
          trend.digest ? (
              <>
                Runs of one campaign, sha256 <Digest of={trend.digest} />
              </>
            ) : (
              `${count(total)} ${total === 1 ? 'run' : 'runs'}, ${trend.campaigns === 1 ? 'one campaign' : `${count(trend.campaigns)} campaigns`}`
            )
        }
      >
        {trend.digest && (
          <ButtonLink to="/trends" search={{ name: trend.name, label: search.label }}>All campaigns of this name</ButtonLink>
        )}
        {(trend.labels.length > 0 || search.label) && (
          <FilterMenu name="Label" options={trend.labels} value={search.label} onChange={narrow} />
        )}
      </PageHead>
      {runs.length === 0 ? (
        <p className="sec">
          {search.label ? 'No run of this campaign has these labels' : 'No run has this campaign'}
          {trend.sweeps > 0 && ' outside a sweep'}.
        </p>
      ) : (
        <div className={layout.grid}>
          <ChartCard
            title={`Worst margin and P(violation) ${along === 'time' ? 'over time' : 'by run'}`}
            note={changesOf(runs)}
            className={layout.c12}
            run="trend"
            data={data}
            right={<Seg label="Horizontal axis" options={ALONG} value={along} onChange={show} />}
          >
            <OutcomesChart points={points} axis={axis} sync="trend" name={({ run }) => run} />
          </ChartCard>
          <Card
            title="Runs"
            note="The newest first"
            className={layout.c12}
            flush
            footer={footerOf(trend)}
          >
            <Runs runs={runs} named={!trend.digest} label={search.label} />
          </Card>
        </div>
      )}
    </>
  )
}

function Runs({ runs, named, label }: { runs: readonly TrendRun[]; named: boolean; label: string[] | undefined }) {
  const stated = runs.some(({ requirements }) => requirements.length > 0)
  const labelled = runs.some(({ labels }) => Object.keys(labels).length > 0)
  const newest = runs.toReversed()
  return (
    <Table
      rows={newest}
      row={(_, i) => ({ className: newest[i - 1]?.code_changed ? styles.changed : undefined })}
      columns={[
        { head: 'No.', num: true, tone: 'sec', cell: (_, i) => runs.length - i },
        ...outcomeColumns(newest),
        named && {
          head: 'Campaign',
          tone: 'sec',
          cell: ({ campaign_digest: campaign, campaign_changed }) => (
            <>
              <Link to="/trends" search={{ campaign, label }} className="mono" title={campaign}>
                {campaign.slice(0, 8)}
              </Link>
              {campaign_changed && ' changed'}
            </>
          ),
        },
        { head: 'Seed', num: true, tone: 'sec', cell: ({ seed }) => seed },
        {
          head: 'Code',
          tone: 'nw',
          cell: ({ code, unidentified, code_changed, code_changes }) => (
            <>
              <CodeCell code={code} unidentified={unidentified} />
              {code_changed && <div className="b" title={code_changes.join(', ')}>changed: {namesOf(code_changes)}</div>}
            </>
          ),
        },
        stated && { head: 'Evidence for', tone: 'sec', cell: ({ requirements }) => <Requirements ids={requirements} /> },
        labelled && { head: 'Labels', tone: 'sec', cell: ({ labels }) => labelsText(labels, ', ') },
        { head: 'Finished', cell: (run) => <DateCell outcome={run} /> },
      ]}
    />
  )
}

/** What the table leaves out. */
function footerOf({ runs, total, sweeps }: Trend): string {
  const newest = total > runs.length ? `The newest ${runs.length} of ${count(total)} runs. ` : ''
  const left = sweeps === 1 ? 'One run of a sweep, of another value, is not shown.' : `${count(sweeps)} runs of sweeps, of other values, are not shown.`
  return newest + (sweeps > 0 ? left : '')
}

const labelsText = (labels: TrendRun['labels'], between: string): string =>
  Object.entries(labels).map(([key, value]) => `${key}=${value}`).join(between)

function Requirements({ ids }: { ids: readonly string[] }) {
  return ids.map((id, at) => (
    <span key={id}>
      {at > 0 && ', '}
      <Link to="/requirements" search={{ q: id }}>
        {id}
      </Link>
    </span>
  ))
}
