// The run list: campaigns, results, progress.
import { clsx } from 'clsx'
import { IconPlus } from '@tabler/icons-react'
import { useInfiniteQuery, useQueryClient } from '@tanstack/react-query'
import { useNavigate, useSearch } from '@tanstack/react-router'
import { useCallback, useMemo, useState } from 'react'
import { useStreamStatus } from '../api/events'
import { refreshRuns } from '../api/lists'
import { runsQuery } from '../api/queries'
import { PageHead } from '../page/PageHead'
import { Unloaded } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { sortOf, statedOf } from './columns'
import { Filters } from './Filters'
import { Marked } from './Marked'
import { NoRuns } from './NoRuns'
import { RunTable } from './RunTable'
import { CLEARED, filterOf, isNarrowed, type RunsSearch } from './search'
import { Button, ButtonLink } from '../ui/Button'
import { cards, layout } from '../ui/styles'
import { usePolling } from '../ui/usePolling'

/** How often the list is asked for without an open stream [ms]. */
const PERIOD = 5000

export function RunsPage() {
  useTitle('Runs')
  const search = useSearch({ from: '/runs' })
  const navigate = useNavigate({ from: '/runs' })
  const query = useInfiniteQuery(runsQuery(filterOf(search, statedOf(sortOf(search.sort)))))
  const cache = useQueryClient()
  usePolling(() => refreshRuns(cache), PERIOD, useStreamStatus() !== 'open')
  const set = useCallback(
    (change: Partial<RunsSearch>) => void navigate({ to: '/runs', search: (before) => ({ ...before, ...change }), replace: true }),
    [navigate],
  )
  const onTag = useCallback((tag: string) => set({ tag: [tag] }), [set])
  const onLabel = useCallback((label: string) => set({ label: [label] }), [set])

  const [marked, setMarked] = useState<ReadonlySet<string>>(new Set())
  const runs = useMemo(() => query.data?.pages.flatMap((page) => page.items) ?? [], [query.data])
  const onMark = useCallback(
    (ids: readonly string[], on: boolean) => setMarked((before) => new Set(on ? [...before, ...ids] : [...before].filter((id) => !ids.includes(id)))),
    [],
  )

  if (!query.data) return <Unloaded query={query} what="runs" title="Runs" onward={false} />
  const counts = query.data.pages[0]?.counts ?? {}
  const none = runs.length === 0 && !isNarrowed(search) && !counts.removed
  const selected = runs.filter((run) => marked.has(run.id))
  return (
    <>
      <PageHead title="Runs">
        {selected.length > 0 && <Marked runs={selected} onClear={() => setMarked(new Set())} />}
        <ButtonLink main icon={IconPlus} to="/launch">New run</ButtonLink>
      </PageHead>
      {none ? (
        <NoRuns />
      ) : (
        <>
          <Filters search={search} counts={counts} onChange={set} />
          {runs.length === 0 ? (
            <NothingFound narrowed={isNarrowed(search)} onChange={set} />
          ) : (
            <RunTable
              runs={runs}
              total={(search.show ? counts[search.show] : counts.total) ?? runs.length}
              cols={search.cols}
              sort={sortOf(search.sort)}
              onSort={(sort) => set({ sort: statedOf(sort) })}
              onTag={onTag}
              onLabel={onLabel}
              marked={marked}
              onMark={onMark}
              removed={search.removed === true}
              more={query.hasNextPage ? () => void query.fetchNextPage() : null}
              loading={query.isFetchingNextPage}
            />
          )}
        </>
      )}
    </>
  )
}

function NothingFound({ narrowed, onChange }: { narrowed: boolean; onChange: (change: Partial<RunsSearch>) => void }) {
  return (
    <div className={clsx(cards.card, layout.centre)}>
      <h2>{narrowed ? 'No run matches' : 'Every run is removed'}</h2>
      <p>{narrowed ? 'Remove a word from the search, or a filter.' : 'They can be restored until they are purged.'}</p>
      <Button onClick={() => onChange(narrowed ? CLEARED : { removed: true })}>
        {narrowed ? 'Clear search and filters' : 'Show removed runs'}
      </Button>
    </div>
  )
}
