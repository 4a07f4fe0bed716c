// Keeps the run list up to date without reloading every page: only the first is requested and merged.
import type { InfiniteData, QueryClient } from '@tanstack/react-query'
import type { RunPage } from '../client'
import { listRuns, type RunFilter } from './calls'

type Pages = InfiniteData<RunPage, string | null>

/** Number of loaded pages above which only the first is requested. */
const FEW = 2

/** Merges a fresh first page: new rows first, existing rows in their order unless they no longer belong here, no duplicates. */
export function renewed(data: Pages, fresh: RunPage, filter: RunFilter = {}): Pages {
  const [first, ...rest] = data.pages
  if (!first) return data
  const known = new Map(fresh.items.map((item) => [item.id, item]))
  const others = (page: RunPage) => page.items.filter((item) => !known.has(item.id) && belongs(item, filter))
  const items = [...fresh.items, ...others(first)]
  const pages = rest.map((page) => ({ ...page, items: others(page) }))
  return { ...data, pages: [{ ...first, items, counts: fresh.counts }, ...pages] }
}

/** Whether the present state of a loaded row matches the filter. */
const belongs = ({ state, verdict, removed }: RunPage['items'][number], filter: RunFilter): boolean =>
  (filter.state?.includes(state) ?? true) &&
  (filter.verdict?.some((word) => word === verdict) ?? true) &&
  (removed ?? null) !== null === (filter.removed ?? false)

/** Refreshes the list with as few requests as possible. */
export function refreshRuns(cache: QueryClient): void {
  for (const query of cache.getQueryCache().findAll({ queryKey: ['runs'], type: 'active' })) {
    const { queryKey } = query
    const data = query.state.data as Partial<Pages> | undefined
    if (!data?.pages || data.pages.length <= FEW) {
      void cache.invalidateQueries({ queryKey, exact: true })
      continue
    }
    void listRuns(queryKey[1] as RunFilter, null).then(
      (fresh) => cache.setQueryData<Pages>(queryKey, (now) => now && renewed(now, fresh, queryKey[1] as RunFilter)),
      () => query.invalidate(),
    )
  }
  void cache.invalidateQueries({ queryKey: ['runs'], refetchType: 'none', type: 'inactive' })
}
