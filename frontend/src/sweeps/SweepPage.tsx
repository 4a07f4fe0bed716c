// A sweep: worst margin and P(violation) over the values of one parameter, and its runs.
import { clsx } from 'clsx'
import { IconBan, IconDownload } from '@tabler/icons-react'
import { queryOptions, useMutation, useQuery, useQueryClient } from '@tanstack/react-query'
import { useParams } from '@tanstack/react-router'
import { useState } from 'react'
import { useBarredFromOwn } from '../api/may'
import { ChartCard } from '../charts/ChartCard'
import { type At, sampleOf } from '../charts/outcomes'
import { OutcomesChart } from '../charts/OutcomesChart'
import { cancelSweep, getSweep, type SweepDetail } from '../client'
import { field, plain } from '../format/numbers'
import { launchedBy } from '../format/people'
import { moment } from '../format/time'
import { ofUnit, unitText } from '../format/units'
import { PageHead } from '../page/PageHead'
import { Unloaded } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { boundOf, CodeCell, DateCell, marginOf, OutcomeBadge, RunCell } from '../trends/cells'
import { Button, ButtonAnchor, ButtonLink } from '../ui/Button'
import { Card } from '../ui/Card'
import { Table } from '../ui/Table'
import { usePolling } from '../ui/usePolling'
import { headlineOf } from '../ui/VerdictBadge'
import { activeOf, statementOf } from './states'
import { at } from '../format/root'
import { cards, layout } from '../ui/styles'

const sweepQuery = (id: string) => queryOptions({ queryKey: ['sweep', id], queryFn: () => getSweep({ path: { sweep: id } }) })

export function SweepPage() {
  const { id } = useParams({ from: '/sweeps/$id' })
  const query = useQuery(sweepQuery(id))
  useTitle(query.data ? `${id} ${query.data.name}` : id)
  usePolling(() => query.refetch(), 2000, query.data !== undefined && activeOf(query.data.states) > 0)
  if (!query.data) return <Unloaded query={query} what={id} />
  return <Shown sweep={query.data} />
}

function Shown({ sweep }: { sweep: SweepDetail }) {
  const points = sweep.points.map(({ value, run, outcome }): At => ({ x: value, run, outcome }))
  const unit = unitText(sweep.unit)
  const axis = {
    xTitle: `${sweep.path}${ofUnit(unit)}`,
    xText: (x: number) => `${sweep.path} = ${plain(x)} ${unit}`.trim(),
  }
  const data = () => ({
    name: 'sweep',
    columns: [`${sweep.path}${unit && ` [${sweep.unit}]`}`, 'run', 'state', 'verdict', 'worst margin', 'unit', 'P(violation) upper bound', 'violations', 'of these failed', 'samples', 'bound source', 'removed', 'unconfirmed', 'excluded samples', 'excluded fraction'],
    rows: sweep.points.map(({ value, run, outcome: o }) => [
      value, run, o?.state ?? 'purged', o && headlineOf(o), o?.margin ?? null, o?.unit ?? null, o?.upper_bound ?? null, o?.violations ?? null,
      o?.failed_samples ?? null, o?.samples ?? null, o?.bound_source ?? null, o && (o.removed ? 'yes' : 'no'), o?.unconfirmed ?? null,
      o?.excluded_samples ?? null, o?.excluded_fraction ?? null,
    ]),
  })
  return (
    <>
      <PageHead
        title={sweep.name}
        note={
          <>
            {sweep.id}, {sweep.title} over {sweep.runs} values. {statementOf(sweep.states)}.
          </>
        }
      >
        <ButtonLink to="/sweeps">All sweeps</ButtonLink>
        <ButtonAnchor icon={IconDownload} href={at(`/api/v1/sweeps/${sweep.id}/table.csv`)} download>CSV</ButtonAnchor>
        {activeOf(sweep.states) > 0 && <Cancel sweep={sweep} />}
      </PageHead>
      {sweep.code_warning && (
        <div className={clsx(cards.note, cards.warn)} style={{ marginBottom: 'var(--gap)' }}>
          {sweep.code_warning}
        </div>
      )}
      <div className={layout.grid}>
        <ChartCard title={`Worst margin and P(violation) over ${sweep.path}`} note={sweep.title} className={layout.c12} run={sweep.id} data={data}>
          <OutcomesChart points={points} axis={axis} sync={sweep.id} name={({ x }) => axis.xText(x)} />
        </ChartCard>
        <Card title="Runs" note={`Submitted by ${launchedBy(sweep)}, ${moment(sweep.created)}`} className={layout.c12} flush>
          <Points sweep={sweep} />
        </Card>
      </div>
    </>
  )
}

function Points({ sweep }: { sweep: SweepDetail }) {
  const rows = sweep.points.map((point) => ({
    ...point,
    reason: [point.outcome?.error, point.outcome?.unconfirmed, point.outcome?.removed && 'Removed from the lists'].filter(Boolean).join(' '),
  }))
  return (
    <Table
      stack
      rows={rows}
      columns={[
        {
          head: sweep.path,
          unit: unitText(sweep.unit),
          label: sweep.path,
          tone: 'b',
          cell: ({ value }) => (
            <>
              {field(value)}
              {value === sweep.nominal && <div className="mut small">in the campaign</div>}
            </>
          ),
        },
        { head: 'Verdict', label: 'Verdict', cell: ({ outcome }) => <OutcomeBadge outcome={outcome} /> },
        { head: 'Run', label: 'Run', cell: ({ run }) => <RunCell run={run} /> },
        { head: 'Worst margin', num: true, label: 'Worst margin', cell: ({ outcome }) => marginOf(outcome) },
        { head: 'P(violation)', unit: 'upper bound', tone: 'sec', label: 'P(violation)', cell: ({ outcome }) => boundOf(outcome) },
        { head: 'Violations', unit: 'of the sample', tone: 'sec', label: 'Violations', cell: ({ outcome }) => sampleOf(outcome) },
        { head: 'Code', label: 'Code', cell: ({ outcome }) => outcome && <CodeCell code={outcome.code} unidentified={outcome.unidentified} /> },
        { head: 'Finished', label: 'Finished', cell: ({ outcome }) => outcome && <DateCell outcome={outcome} /> },
        rows.some(({ reason }) => reason) && { head: 'Reason', tone: 'sec', cell: ({ reason }) => reason },
      ]}
    />
  )
}

/** Asks once; completed evaluations are kept. */
function Cancel({ sweep }: { sweep: SweepDetail }) {
  const [sure, setSure] = useState(false)
  const cache = useQueryClient()
  const cancel = useMutation({
    mutationFn: () => cancelSweep({ path: { sweep: sweep.id } }),
    onSuccess: (after) => {
      cache.setQueryData(sweepQuery(sweep.id).queryKey, after)
      void cache.invalidateQueries({ queryKey: ['runs'] })
      setSure(false)
    },
  })
  const barred = useBarredFromOwn('engineer', sweep)
  const active = activeOf(sweep.states)
  if (!sure)
    return (
      <Button icon={IconBan} barred={barred} onClick={() => setSure(true)}>Cancel</Button>
    )
  return (
    <span className={layout.row}>
      <span className="sec">{cancel.error ? cancel.error.message : `Cancel ${active === 1 ? 'the run' : `the ${active} runs`} that have not ended?`}</span>
      <Button main disabled={cancel.isPending} onClick={() => cancel.mutate()}>
        Cancel {active === 1 ? 'it' : 'them'}
      </Button>
      <Button onClick={() => setSure(false)}>Keep running</Button>
    </span>
  )
}
