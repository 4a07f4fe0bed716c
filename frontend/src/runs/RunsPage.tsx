// The run list: what was asked, what came of it, what is being worked on.
import { IconPlus } from '@tabler/icons-react'
import { useInfiniteQuery } from '@tanstack/react-query'
import { Link, useNavigate, useSearch } from '@tanstack/react-router'
import { useStream } from '../api/events'
import { runsQuery } from '../api/queries'
import { Loading, Trouble } from '../app/Trouble'
import { useTitle } from '../app/useTitle'
import { useHotkeys } from '../ui/useHotkeys'
import { Filters } from './Filters'
import { NoRuns } from './NoRuns'
import { RunTable } from './RunTable'
import { filterOf, type RunsSearch } from './search'

export function RunsPage() {
  useTitle('Runs')
  useStream(null)
  const search = useSearch({ from: '/runs' })
  const navigate = useNavigate()
  const query = useInfiniteQuery(runsQuery(filterOf(search)))
  const set = (change: Partial<RunsSearch>) =>
    void navigate({ to: '/runs', search: { ...search, ...change }, replace: true })
  useHotkeys({ n: () => void navigate({ to: '/launch' }) })

  if (query.isPending) return <Loading what="runs" />
  if (query.isError) return <Trouble error={query.error} retry={() => void query.refetch()} />
  const runs = query.data.pages.flatMap((page) => page.items)
  const counts = query.data.pages[0]?.counts ?? {}
  const narrowed = Boolean(search.q || search.show || search.tag)
  const none = runs.length === 0 && !narrowed
  return (
    <>
      <div className="ph">
        <div className="t">
          <h1>Runs</h1>
        </div>
        <div className="acts">
          <Link to="/launch" className="btn p">
            <IconPlus className="i s" aria-hidden />
            New run
          </Link>
        </div>
      </div>
      {none ? (
        <NoRuns />
      ) : (
        <>
          <Filters search={search} counts={counts} onChange={set} />
          {runs.length === 0 ? (
            <NothingFound onClear={() => set({ q: undefined, show: undefined, tag: undefined })} />
          ) : (
            <RunTable
              runs={runs}
              sort={search.sort ?? '-created'}
              onSort={(sort) => set({ sort: sort === '-created' ? undefined : sort })}
              onTag={(tag) => set({ tag })}
              more={query.hasNextPage ? () => void query.fetchNextPage() : null}
              loading={query.isFetchingNextPage}
            />
          )}
        </>
      )}
    </>
  )
}

function NothingFound({ onClear }: { onClear: () => void }) {
  return (
    <div className="card centre">
      <h2>No run matches</h2>
      <p>Nothing fits this search and these filters together.</p>
      <button type="button" className="btn" onClick={onClear}>
        Clear search and filters
      </button>
    </div>
  )
}
