// The one event stream of this tab: it feeds the query cache, at most four times a second. It is closed while the tab is
// hidden, because a browser has only six connections to a service; while it is lost, pages poll. Start: `useStream`, `feed`.
import { type InfiniteData, type QueryClient, useQueryClient } from '@tanstack/react-query'
import { useEffect, useLayoutEffect } from 'react'
import type { EvaluationSeries, Evaluations, RunDetail, RunPage, RunSummary, StageProgress, Workers } from '../client'
import { Feed } from './feed'
import { refreshRuns } from './lists'
import { isLive } from './queries'
import { at } from '../format/root'
import { storeOf } from '../ui/store'

const FLUSH = 250

type Status = 'closed' | 'connecting' | 'open'

const status = storeOf<Status>('closed')
/** How many parts of the page have a stream of their own: never more than one, besides while one replaces another. */
const own = storeOf(0)
let streams = 0

function set(next: Status): void {
  // While one stream replaces another the first one to close does not count.
  if (next !== 'closed' || streams === 0) status.set(next)
}

/** The state of this tab's stream, for display. */
export const useStreamStatus = status.useValue

/** The stream of all pages without one of their own: all runs, and the workers in the header. */
export function useBaseStream(): void {
  useSource(null, own.useValue() === 0)
}

export interface Improvements {
  index: number[]
  seconds: number[]
  cost: number[]
  evaluations: number
  /** The parameters of the last one. */
  parameters: Record<string, number>
}

/** Subscribes to a run with its stages and improvements, in place of all runs, while the page is visible. */
export function useStream(run: string, on = true): void {
  useLayoutEffect(() => {
    if (!on) return
    own.set(own.get() + 1)
    return () => own.set(own.get() - 1)
  }, [on])
  useSource(run, on)
}

function useSource(run: string | null, on: boolean): void {
  const cache = useQueryClient()
  useEffect(() => {
    if (!on) return
    let feed: Feed | null = null
    const pending: (() => void)[] = []
    const tick = setInterval(() => {
      for (const apply of pending.splice(0)) apply()
      feed?.tick()
    }, FLUSH)
    const later = (apply: (data: never) => void) => (text: string) => pending.push(() => apply(JSON.parse(text) as never))
    const events = {
      run: later((data: RunSummary) => putRun(cache, data)),
      workers: later((data: Workers) => cache.setQueryData<Workers>(['workers'], data)),
      stages: later((data: StageProgress[]) => run && putStages(cache, run, data)),
      evaluations: later((data: Record<string, Improvements>) => run && putImprovements(cache, run, data)),
    }
    const refresh = () => {
      if (run) void cache.invalidateQueries({ queryKey: ['run', run] })
      else refreshRuns(cache)
    }
    const open = () => {
      streams++
      feed = new Feed(at(`/api/v1/events${run ? `?run=${encodeURIComponent(run)}` : ''}`), events, {
        open: (open) => set(open ? 'open' : 'connecting'),
        missed: refresh,
      })
    }
    const close = () => {
      if (feed) streams--
      feed?.close()
      feed = null
      set('closed')
    }
    const visible = () => {
      if (document.hidden) close()
      else if (!feed) {
        open()
        refresh()
      }
    }
    // The connection of before may be one by another network.
    const online = () => feed?.renew()
    document.addEventListener('visibilitychange', visible)
    window.addEventListener('online', online)
    if (!document.hidden) open()
    return () => {
      document.removeEventListener('visibilitychange', visible)
      window.removeEventListener('online', online)
      clearInterval(tick)
      close()
    }
  }, [cache, run, on])
}

const isPaged = (data: unknown) => typeof data === 'object' && data !== null && 'pages' in data

/** Writes a run's new summary into the list and its own page; invalidates what depends on its end. */
export function putRun(cache: QueryClient, run: RunSummary): void {
  let [listed, moved] = [false, false]
  const lists = { queryKey: ['runs'], predicate: (query: { state: { data: unknown } }) => isPaged(query.state.data) }
  cache.setQueriesData<InfiniteData<RunPage>>(lists, (data) => {
    if (!data?.pages.some((page) => page.items.some((item) => item.id === run.id))) return data
    listed = true
    moved ||= data.pages.some((page) => page.items.some((item) => item.id === run.id && item.state !== run.state))
    const items = (page: RunPage) => page.items.map((item) => (item.id === run.id ? run : item))
    return { ...data, pages: data.pages.map((page) => ({ ...page, items: items(page) })) }
  })
  const before = cache.getQueryData<RunDetail>(['run', run.id])
  if (before) cache.setQueryData<RunDetail>(['run', run.id], { ...before, ...run })
  // Counts and lists of one state change with it.
  if (!listed || moved || !isLive(run)) refreshRuns(cache)
  if (before && isLive(before) && !isLive(run))
    for (const key of ['run', 'stages', 'evaluations', 'findings', 'traces', 'trace'])
      void cache.invalidateQueries({ queryKey: [key, run.id] })
}

export function putStages(cache: QueryClient, run: string, stages: StageProgress[]): void {
  const before = cache.getQueryData<RunDetail>(['run', run])
  if (before) cache.setQueryData<RunDetail>(['run', run], { ...before, stages })
  const read = cache.getQueryData<Evaluations>(['evaluations', run])?.stages ?? []
  const started = new Map(stages.map((stage) => [stage.position, stage.started]))
  // The run was reset: what was read of it is discarded.
  if (read.some((stage) => started.get(stage.position) !== stage.started))
    for (const key of ['stages', 'evaluations', 'findings', 'traces', 'trace'])
      void cache.invalidateQueries({ queryKey: [key, run] })
  const done = (list: readonly StageProgress[] | undefined) => list?.filter((s) => s.state === 'done').length ?? 0
  // A stage that has just ended has a result now.
  if (done(stages) !== done(before?.stages)) {
    void cache.invalidateQueries({ queryKey: ['stages', run] })
    void cache.invalidateQueries({ queryKey: ['findings', run] })
  }
}

export function putImprovements(cache: QueryClient, run: string, news: Record<string, Improvements>): void {
  const before = cache.getQueryData<Evaluations>(['evaluations', run])
  if (!before) return
  const known = new Set(before.stages.map((stage) => String(stage.position)))
  if (Object.keys(news).some((position) => !known.has(position))) {
    // A request that is under way is not made again with every event: the next one after it is.
    const only = { queryKey: ['evaluations', run], exact: true }
    if (cache.isFetching(only) === 0) void cache.invalidateQueries(only)
    return
  }
  const stages = before.stages.map((stage) => {
    const fresh = news[String(stage.position)]
    return fresh ? extended(stage, fresh) : stage
  })
  cache.setQueryData<Evaluations>(['evaluations', run], { ...before, stages })
}

/** A series with improvements appended; duplicates are skipped, so a repeated event is harmless. */
export function extended(stage: EvaluationSeries, fresh: Improvements): EvaluationSeries {
  const { index = [], seconds = [], cost = [] } = stage.improvements
  const last = index[index.length - 1] ?? -1
  const from = fresh.index.findIndex((i) => i > last)
  const total = Math.max(stage.total, fresh.evaluations)
  if (from < 0) return { ...stage, total }
  return {
    ...withBest(stage, fresh),
    total,
    improvements: {
      index: [...index, ...fresh.index.slice(from)],
      seconds: [...seconds, ...fresh.seconds.slice(from)],
      cost: [...cost, ...fresh.cost.slice(from)],
    },
  }
}

/** The known evaluations, with the best of the new ones: the only one whose parameters are sent. */
function withBest(stage: EvaluationSeries, fresh: Improvements): EvaluationSeries {
  const [at, seconds, cost] = [fresh.index.at(-1), fresh.seconds.at(-1), fresh.cost.at(-1)]
  if (at === undefined || seconds === undefined || cost === undefined) return stage
  if (at <= (stage.index.at(-1) ?? -1) || Object.keys(fresh.parameters).length === 0) return stage
  const parameters: Record<string, number[]> = {}
  for (const [path, values] of Object.entries(stage.parameters))
    parameters[path] = [...values, fresh.parameters[path] ?? Number.NaN]
  // The stream sends only the deciding value; the others come when the evaluations are read again.
  const further: Record<string, (number | null)[]> = {}
  for (const [name, values] of Object.entries(stage.further)) further[name] = [...values, null]
  return {
    ...stage,
    index: [...stage.index, at],
    seconds: [...stage.seconds, seconds],
    cost: [...stage.cost, cost],
    status: [...stage.status, 'ok'],
    parameters,
    further,
  }
}
