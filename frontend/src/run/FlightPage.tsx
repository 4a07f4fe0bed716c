// The 3D view of a run in its own window with all controls, also for an active run.
import { clsx } from 'clsx'
import { Link, useParams, useSearch } from '@tanstack/react-router'
import { useEffect, useMemo, useState } from 'react'
import { caseWord, hasScenario } from '../api/campaign'
import { Refusal } from '../api/problems'
import { isLive } from '../api/queries'
import type { RunDetail } from '../client'
import { Loading, Trouble } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { ButtonLink } from '../ui/Button'
import { RunBadge } from '../ui/VerdictBadge'
import { useRunData } from './data/data'
import { useRun } from './data/useRun'
import { hasView } from './flight/declared'
import { Flight } from './flight/Flight'
import { Declare } from './flight/Untraced'
import { useWhatIf } from './flight/useWhatIf'
import { View } from './flight/view'
import { WhatIfCard } from './flight/WhatIfCard'
import { Missing } from './header/Missing'
import { Purged } from './header/Removed'
import { cards, layout } from '../ui/styles'
import styles from './run.module.css'

export function FlightPage() {
  const { id } = useParams({ from: '/runs/$id' })
  useTitle(`${id} flight`)
  const query = useRun(id)
  if (query.error instanceof Refusal && query.error.status === 410) return <Purged id={id} statement={query.error.message} />
  if (query.isError && !query.data) return <Trouble error={query.error} retry={() => void query.refetch()} />
  if (!query.data) return <Loading what="run" title={id} />
  return <Page key={id} run={query.data} />
}

function NoTrace({ run }: { run: RunDetail }) {
  return (
    <div className={clsx(cards.card, layout.centre)}>
      <h1>There is no {isLive(run) ? '3D view yet' : '3D view'}</h1>
      <p>
        {isLive(run)
          ? 'This run evaluates a simulator: its 3D view can be opened when the run has ended, if its trace states which columns are positions.'
          : 'This run evaluates a simulator, and no stored trace of it states which columns are positions.'}{' '}
        Its results, and its trace over time if it returns one, are on the page of the run.
      </p>
      {!isLive(run) && <Declare />}
      <div className={layout.acts}>
        <ButtonLink to="/runs/$id" params={{ id: run.id }}>Open {run.id}</ButtonLink>
      </div>
    </div>
  )
}

function Page({ run }: { run: RunDetail }) {
  useTitle(`${run.id} ${run.name}, flight`)
  const data = useRunData(run, useSearch({ from: '/runs/$id' }).finding)
  const flies = hasScenario(data.campaign)
  const view = useMemo(() => new View(run.id, flies), [run.id, flies])
  const whatIf = useWhatIf(data, view)
  // The chosen flight is known once the findings are loaded.
  const [ready, setReady] = useState(false)
  if (data.complete && !ready) setReady(true)
  const live = isLive(run)
  useEffect(() => {
    // The panel shows the convergence of the searches; a narrow window has no room for it.
    if (live && !matchMedia('(max-width: 760px)').matches) view.steer({ panel: true })
  }, [view, live])
  if (!ready) return <Loading what={caseWord(data.campaign)} />
  const absent = data.missing.length > 0
  if (!flies && !hasView(data)) return absent ? <Missing parts={data.missing} /> : <NoTrace run={run} />
  return (
    <div className={styles.own}>
      <div className={layout.ph}>
        <div className={layout.grow}>
          <nav className={clsx(layout.row, layout.wrapAny, 'mut small', styles.crumb)} aria-label="Breadcrumb">
            <Link to="/runs" className="sec">Runs</Link>/
            <Link to="/runs/$id" params={{ id: run.id }} search={(before) => before} className="mono sec">
              {run.id}
            </Link>
            /<span>{flies ? 'Flight' : '3D view'}</span>
          </nav>
          <div className={clsx(layout.row, styles.titles)}>
            <h1>{run.name}</h1>
            <RunBadge run={run} />
          </div>
        </div>
      </div>
      <Missing parts={data.missing} />
      {!live && !absent && data.traces.length === 0 && (
        <p className={cards.note} style={{ marginBottom: 'var(--gap)' }} role="status">
          No {caseWord(data.campaign)} of this run is stored: it ended before its nominal case was stored. The view shows the
          scenario; “What-if” simulates a case of it.
        </p>
      )}
      <div className={clsx(layout.grid, styles.whole)}>
        <Flight data={data} view={view} whatIf={whatIf} className={whatIf.whatIf ? layout.c8 : layout.c12} alone />
        <WhatIfCard data={data} state={whatIf} className={layout.c4} />
      </div>
    </div>
  )
}
