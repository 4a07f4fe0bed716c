// The page of a run: progress while it is active, then the verdict and its evidence.
import { useParams, useSearch } from '@tanstack/react-router'
import { memo, useState } from 'react'
import { Refusal } from '../api/problems'
import { isLive } from '../api/queries'
import { Loading, Trouble } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import type { RunDetail } from '../client'
import { useRunData } from './data/data'
import { useRun } from './data/useRun'
import { Finished } from './Finished'
import { Head } from './header/Head'
import { History } from './header/History'
import { Live } from './Live'
import { Missing } from './header/Missing'
import { Purged, Removed } from './header/Removed'
import { RelatedCard } from '../trends/RelatedCard'
import { layout } from '../ui/styles'

/** The longest part of a page: rendered again only if its data change. */
const Evidence = memo(Finished)

export function RunPage() {
  const { id } = useParams({ from: '/runs/$id' })
  useTitle(id)
  const query = useRun(id)
  if (query.error instanceof Refusal && query.error.status === 410) return <Purged id={id} statement={query.error.message} />
  if (query.isError && !query.data) return <Trouble error={query.error} retry={() => void query.refetch()} />
  if (!query.data) return <Loading what="run" title={id} />
  return <Page key={query.data.id} run={query.data} stale={query.isError} />
}

function Page({ run, stale }: { run: RunDetail; stale: boolean }) {
  useTitle(`${run.id} ${run.name}`)
  const data = useRunData(run, useSearch({ from: '/runs/$id' }).finding)
  // Rendered once the layout is known, and from then on also during refetches.
  const [drawn, setDrawn] = useState(false)
  if (!isLive(run) && data.complete && !drawn) setDrawn(true)
  return (
    <>
      <Head run={run} stale={stale} />
      {run.removed !== null && <Removed run={run} />}
      <Missing parts={data.missing} />
      {isLive(run) ? <Live data={data} /> : drawn ? <Evidence data={data} /> : <Loading what="results" />}
      <div className={layout.grid} style={{ marginTop: 'var(--gap)' }}>
        <RelatedCard run={run} />
        <History run={run.id} />
      </div>
    </>
  )
}
