// Keeps the run list fresh without asking for every loaded page again: only the first, put before what is there.
import type { InfiniteData, QueryClient } from '@tanstack/react-query'
import type { RunPage } from '../client'
import { listRuns, type RunFilter } from './calls'

type Pages = InfiniteData<RunPage, string | null>

/** Loaded pages beyond which only the first is asked for. */
const FEW = 2

/** The pages with a fresh first one: what is new stands in front, what was there keeps its place, nothing twice. */
export function renewed(data: Pages, fresh: RunPage): Pages {
  const [first, ...rest] = data.pages
  if (!first) return data
  const known = new Map(fresh.items.map((item) => [item.id, item]))
  const others = (page: RunPage) => page.items.filter((item) => !known.has(item.id))
  const items = [...fresh.items, ...others(first)]
  const pages = rest.map((page) => ({ ...page, items: others(page) }))
  return { ...data, pages: [{ ...first, items, counts: fresh.counts }, ...pages] }
}

/** Asks again for what the list shows, as little of it as will do. */
export function refreshRuns(cache: QueryClient): void {
  for (const query of cache.getQueryCache().findAll({ queryKey: ['runs'], type: 'active' })) {
    const { queryKey } = query
    const data = query.state.data as Pages | undefined
    if (!data || data.pages.length <= FEW) {
      void cache.invalidateQueries({ queryKey, exact: true })
      continue
    }
    void listRuns(queryKey[1] as RunFilter, null).then(
      (fresh) => cache.setQueryData<Pages>(queryKey, (now) => now && renewed(now, fresh)),
      () => query.invalidate(),
    )
  }
  void cache.invalidateQueries({ queryKey: ['runs'], refetchType: 'none', type: 'inactive' })
}
