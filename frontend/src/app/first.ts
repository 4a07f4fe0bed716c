// What a page shows first is in the query cache before the page is drawn, if the service is quick: it is drawn once, not
// with every answer. The requests are those of `api/ahead`.
import {
  catalogueQuery, componentsQuery, draftsQuery, evaluationsQuery, facetsQuery, findingsQuery, libraryQuery, queryClient,
  runQuery, runsQuery, sessionQuery, stagesQuery, traceQuery, tracesQuery, workersQuery,
} from '../api/queries'
import { inside } from '../format/root'

/** After which the page is drawn with what there is [ms]. */
const PATIENCE = 500

/** Resolves when the page at this address can be drawn; never rejects. */
export async function loaded({ pathname, search }: Pick<Location, 'pathname' | 'search'>): Promise<void> {
  const path = inside(pathname)
  const run = /^\/runs\/(R-\d+)$/.exec(path)?.[1]
  const own = run ? ofRun(run, new URLSearchParams(search).get('finding') ?? 'F1') : path === '/runs' && search ? [] : (PAGES[path]?.() ?? [])
  // Without its fonts a page would be laid out twice.
  const fonts = [...document.fonts].filter((font) => font.status === 'loading').map((font) => font.loaded)
  const all = Promise.allSettled([queryClient.prefetchQuery(sessionQuery), queryClient.prefetchQuery(workersQuery), ...own, ...fonts])
  await Promise.race([all, new Promise((resolve) => setTimeout(resolve, PATIENCE))])
}

const PAGES: Record<string, () => Promise<unknown>[]> = {
  '/runs': () => [queryClient.prefetchInfiniteQuery(runsQuery({})), queryClient.prefetchQuery(facetsQuery)],
  '/launch': () => [
    queryClient.prefetchQuery(catalogueQuery),
    queryClient.prefetchQuery(libraryQuery),
    queryClient.prefetchQuery(facetsQuery),
    queryClient.prefetchQuery(draftsQuery),
  ],
}

const ofRun = (run: string, chosen: string): Promise<unknown>[] => [
  queryClient.prefetchQuery(runQuery(run)),
  queryClient.prefetchQuery(stagesQuery(run)),
  queryClient.prefetchQuery(findingsQuery(run)),
  queryClient.prefetchQuery(componentsQuery(run)),
  queryClient.prefetchQuery(evaluationsQuery(run)),
  flightsOf(run, chosen),
]

async function flightsOf(run: string, chosen: string): Promise<unknown> {
  await queryClient.prefetchQuery(tracesQuery(run))
  const stored = queryClient.getQueryData(tracesQuery(run).queryKey) ?? []
  const shown = stored.filter(({ name }) => name === 'nominal' || name === chosen)
  return Promise.all(shown.map(({ name }) => queryClient.prefetchQuery(traceQuery(run, name))))
}
