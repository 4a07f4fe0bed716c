// What the run list can be set to, as it stands in the address.
import type { RunFilter } from '../api/calls'

export const SHOWS = ['cleared', 'violated', 'inconclusive', 'running', 'queued', 'failed', 'cancelled'] as const
export type Show = (typeof SHOWS)[number]

const SORTS = ['created', 'started', 'name', 'verdict', 'worst', 'margin', 'evaluations'] as const
export type SortKey = (typeof SORTS)[number]
export type Sort = SortKey | `-${SortKey}`

export interface RunsSearch {
  q?: string
  show?: Show
  tag?: string
  sort?: Sort
}

const text = (value: unknown): string | undefined =>
  typeof value === 'string' || typeof value === 'number' ? String(value) || undefined : undefined

const isSort = (value: string | undefined): value is Sort =>
  value !== undefined && SORTS.some((sort) => value === sort || value === `-${sort}`)

export function readSearch(search: Record<string, unknown>): RunsSearch {
  const show = SHOWS.find((word) => word === search.show)
  const sort = text(search.sort)
  return { q: text(search.q), show, tag: text(search.tag), sort: isSort(sort) ? sort : undefined }
}

export function filterOf({ q, show, tag, sort }: RunsSearch): RunFilter {
  const filter: RunFilter = {}
  if (q) filter.q = q
  if (tag) filter.tag = [tag]
  if (sort) filter.sort = sort
  if (show === 'cleared' || show === 'violated' || show === 'inconclusive') filter.verdict = [show]
  else if (show === 'running') filter.state = ['running', 'cancelling']
  else if (show) filter.state = [show]
  return filter
}
