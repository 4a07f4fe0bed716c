// The query cache: keys and freshness of the service's responses. The event stream writes into the same cache.
import {
  infiniteQueryOptions, type InvalidateOptions, type InvalidateQueryFilters, MutationCache, QueryCache, QueryClient, queryOptions,
} from '@tanstack/react-query'
import type { ReweightRequest, RunSummary, TraceHead } from '../client'
import { learnMethods, requestBy } from '../ui/methods'
import * as sdk from '../client'
import { getRun, getSchema, listRuns, type RunFilter } from './calls'
import { Refusal } from './problems'
import { signedOut } from './session'

const refused = (error: unknown, ...status: number[]): boolean =>
  error instanceof Refusal && status.includes(error.status)

/** A first request that is under way may be answered from before the change: it is made again, as later ones are. */
export class Cache extends QueryClient {
  override invalidateQueries(filters: InvalidateQueryFilters = {}, options?: InvalidateOptions): Promise<void> {
    if (filters.refetchType !== 'none')
      for (const query of this.getQueryCache().findAll({ ...filters, fetchStatus: 'fetching' }))
        if (query.state.data === undefined && query.isActive()) void query.cancel({ silent: true })
    return super.invalidateQueries(filters, options)
  }
}

const onError = (error: unknown) => {
  if (refused(error, 401)) signedOut()
}

export const queryClient = new Cache({
  queryCache: new QueryCache({ onError }),
  mutationCache: new MutationCache({ onError }),
  defaultOptions: {
    queries: {
      staleTime: 15_000,
      retry: (count, error) => count < 2 && !refused(error, 400, 401, 403, 404, 410, 422),
    },
  },
})

/** The states of a run that has not ended. */
export const LIVE = ['queued', 'running', 'cancelling'] as const

export const isLive = (run: Pick<RunSummary, 'state'>): boolean => LIVE.some((state) => state === run.state)

export const sessionQuery = queryOptions({ queryKey: ['session'], queryFn: () => sdk.getSession(), staleTime: 60_000 })

/** Who executes runs; kept up to date by the event stream where there is one. */
export const workersQuery = queryOptions({ queryKey: ['workers'], queryFn: () => sdk.listWorkers(), staleTime: 4000 })

/** A worker publishes the catalogue when it starts; until then the service returns 503. */
const untilPublished = {
  retry: (count: number, error: Error) => refused(error, 503) || (count < 2 && !refused(error, 404, 410)),
  retryDelay: 1500,
}

export const catalogueQuery = queryOptions({
  ...untilPublished,
  queryKey: ['catalogue'],
  queryFn: async () => learnMethods(await sdk.listComponents()),
  staleTime: 10_000, // a component may have been edited in another window
})

requestBy(() => queryClient.prefetchQuery(catalogueQuery))

export const libraryQuery = queryOptions({ queryKey: ['library'], queryFn: () => sdk.listCampaigns(), staleTime: 300_000 })

export const schemaQuery = queryOptions({
  queryKey: ['schema'],
  queryFn: getSchema,
  staleTime: Number.POSITIVE_INFINITY,
})

export const draftsQuery = queryOptions({ queryKey: ['drafts'], queryFn: () => sdk.listDrafts() })

/** Read once: edits are based on the version that was opened. */
export const draftQuery = (id: string) =>
  queryOptions({
    queryKey: ['draft', id],
    queryFn: () => sdk.getDraft({ path: { draft: id } }),
    staleTime: Number.POSITIVE_INFINITY,
    gcTime: 0,
  })

/** A list that is loaded in pages, each of which names the next. */
export const paged = <P extends { next_cursor: string | null }>(queryKey: readonly unknown[], ask: (cursor: string | null) => Promise<P>, staleTime?: number) =>
  infiniteQueryOptions({
    queryKey,
    queryFn: ({ pageParam }) => ask(pageParam),
    initialPageParam: null as string | null,
    getNextPageParam: (page) => page.next_cursor,
    placeholderData: (before) => before,
    ...(staleTime !== undefined && { staleTime }),
  })

export const runsQuery = (filter: RunFilter) => paged(['runs', filter], (cursor) => listRuns(filter, cursor))

/** The values by which the list can be filtered. */
export const facetsQuery = queryOptions({ queryKey: ['facets'], queryFn: () => sdk.listFacets() })

export const runQuery = (id: string) => queryOptions({ queryKey: ['run', id], queryFn: () => getRun(id) })

/** The descriptions of a run's components, stored with it and therefore independent of the installation. */
export const componentsQuery = (id: string) =>
  queryOptions({
    ...untilPublished,
    queryKey: ['components', id],
    queryFn: async () => {
      const components = await sdk.listRunComponents({ path: { run: id } })
      learnMethods(components.catalogue, true)
      return components
    },
    staleTime: 300_000,
  })

/** Between the code of two runs, which no longer changes once both have started. */
export const codeQuery = (id: string, against: string) =>
  queryOptions({ queryKey: ['code', id, against], queryFn: () => sdk.compareCode({ path: { run: id }, query: { against } }), staleTime: 300_000 })

export const stagesQuery = (id: string) =>
  queryOptions({ queryKey: ['stages', id], queryFn: () => sdk.listStages({ path: { run: id } }) })

/** Whether cases of a run's simulator can be evaluated; asked when the what-if opens, because it starts a process. */
export const caseInstalledQuery = (id: string) =>
  queryOptions({ queryKey: ['case installed', id], queryFn: () => sdk.caseInstalled({ path: { run: id } }), staleTime: 60_000, retry: false })

/** What charts of the search show: every improvement, the best point, and the first evaluations without a value. */
export const evaluationsQuery = (id: string) =>
  queryOptions({ queryKey: ['evaluations', id], queryFn: () => sdk.getEvaluations({ path: { run: id }, query: { max_points: 2 } }) })

/** With an even selection of all evaluations, which takes a megabyte of a long search; those of a run that is over change no more. */
export const pointsQuery = ({ id, state }: Pick<RunSummary, 'id' | 'state'>) =>
  queryOptions({
    queryKey: ['evaluations', id, 'points', isLive({ state })],
    queryFn: () => sdk.getEvaluations({ path: { run: id }, query: { max_points: 2000 } }),
    ...(!isLive({ state }) && { staleTime: 300_000 }),
  })

/** Computed at every request, so it is read once after the run has ended. */
export const coverageQuery = (id: string) =>
  queryOptions({ queryKey: ['coverage', id], queryFn: () => sdk.getCoverage({ path: { run: id } }), staleTime: 300_000 })

export const findingsQuery = (id: string) =>
  queryOptions({ queryKey: ['findings', id], queryFn: () => sdk.listFindings({ path: { run: id } }) })

/** Computed from all evaluations when it is asked for. */
export const mostLikelyQuery = (id: string) =>
  queryOptions({ queryKey: ['most likely', id], queryFn: () => sdk.getMostLikely({ path: { run: id } }) })

/** The independent sample, re-weighted to other distributions. */
export const reweightedQuery = (id: string, body: ReweightRequest) =>
  queryOptions({
    queryKey: ['reweighted', id, body],
    queryFn: ({ signal }) => sdk.reweightSample({ path: { run: id }, body, signal }),
    placeholderData: (before, query) => (query?.queryKey[1] === id ? before : undefined),
    retry: false,
  })

export const tracesQuery = (id: string) =>
  queryOptions({ queryKey: ['traces', id], queryFn: () => sdk.listTraces({ path: { run: id } }).then((all) => all.map(counted)) })

const getTrace = (run: string, name: string, most: number) =>
  sdk.getTrace({ path: { run, name }, query: { max_points: most } }).then(counted)

/** A flight without a closest approach if it did not end ok: how near a failed one came is no value of it. */
export const counted = <T extends { meta: TraceHead }>(trace: T): T =>
  trace.meta.status === 'ok' ? trace : { ...trace, meta: { ...trace.meta, closest: null } }

export const traceQuery = (id: string, name: string) =>
  queryOptions({ queryKey: ['trace', id, name], queryFn: () => getTrace(id, name, 1500), staleTime: 300_000 })

/** A flight with few rows, for a thumbnail. */
export const sketchQuery = (id: string, name: string) =>
  queryOptions({ queryKey: ['trace', id, name, 'sketch'], queryFn: () => getTrace(id, name, 160), staleTime: 300_000 })
