// The state of the run list in the address.
import type { RunFilter } from '../api/calls'
import { COLUMN_KEYS, type ColumnKey, type SortKey, SORTS } from './columnKeys'
import { flag, pairs, text, words } from '../format/query'

export const SHOWS = ['cleared', 'violated', 'inconclusive', 'running', 'queued', 'failed', 'cancelled'] as const
export type Show = (typeof SHOWS)[number]

export type Sort = SortKey | `-${SortKey}`

export const DAYS = [1, 7, 30] as const
export type Days = (typeof DAYS)[number]

export interface RunsSearch {
  q?: string
  show?: Show
  campaign?: string[]
  tag?: string[]
  owner?: string[]
  method?: string[]
  /** Labels as key=value. */
  label?: string[]
  /** Submitted today, or in the last days. */
  days?: Days
  /** Days as 2026-11-20, both included. */
  since?: string
  until?: string
  pinned?: true
  /** Removed runs instead of listed ones. */
  removed?: true
  sort?: Sort
  cols?: ColumnKey[]
  /** Initial focus: the search box, if requested from another page. */
  focus?: 'search'
}

/** The filters of the list; clearing them keeps order and columns. */
export const NARROWING = ['q', 'show', 'campaign', 'tag', 'owner', 'method', 'label', 'days', 'since', 'until', 'pinned', 'removed'] as const
export const CLEARED = Object.fromEntries(NARROWING.map((key) => [key, undefined])) as Partial<RunsSearch>

export const isNarrowed = (search: RunsSearch): boolean => NARROWING.some((key) => search[key] !== undefined)

const isSort = (value: string | undefined): value is Sort =>
  value !== undefined && SORTS.some((sort) => value === sort || value === `-${sort}`)

function date(value: unknown): string | undefined {
  const found = text(value)
  return found && /^\d{4}-\d\d-\d\d$/.test(found) && !Number.isNaN(Date.parse(found)) ? found : undefined
}

/** The columns in their fixed order, independent of the address. */
function columns(value: unknown): ColumnKey[] | undefined {
  if (typeof value !== 'string') return undefined
  const keys = value.split(',')
  return COLUMN_KEYS.filter((key) => keys.includes(key))
}

/** Parses the address; unknown values are ignored. */
export function readSearch(search: Record<string, unknown>): RunsSearch {
  const sort = text(search.sort)
  const found: RunsSearch = {
    q: text(search.q),
    show: SHOWS.find((word) => word === search.show),
    campaign: words(search.campaign),
    tag: words(search.tag),
    owner: words(search.owner),
    method: words(search.method),
    label: words(pairs(search.label)),
    days: DAYS.find((days) => days === Number(search.days)),
    since: date(search.since),
    until: date(search.until),
    pinned: flag(search.pinned),
    removed: flag(search.removed),
    focus: search.focus === 'search' ? 'search' : undefined,
    sort: isSort(sort) ? sort : undefined,
    cols: Array.isArray(search.cols) ? columns(search.cols.join()) : columns(search.cols),
  }
  return Object.fromEntries(Object.entries(found).filter(([, value]) => value !== undefined))
}

const DAY = 86_400_000

/** Midnight in the browser's time zone [s since 1970], so that the same day always gives the same query. */
function midnight(day: string | Date, later = 0): number {
  const at = typeof day === 'string' ? new Date(`${day}T00:00:00`) : new Date(day)
  at.setHours(0, 0, 0, 0)
  at.setDate(at.getDate() + later)
  return at.getTime() / 1000
}

export function filterOf(search: RunsSearch, now = Date.now()): RunFilter {
  const { show, days, since, until, q, sort, campaign, tag, owner, method, label, pinned, removed } = search
  const filter: RunFilter = { q, sort, campaign, tag, owner, method, label, pinned, removed }
  if (days) filter.since = midnight(new Date(now - (days - 1) * DAY))
  if (since) filter.since = midnight(since)
  if (until) filter.until = midnight(until, 1)
  if (show === 'cleared' || show === 'violated' || show === 'inconclusive') filter.verdict = [show]
  else if (show === 'running') filter.state = ['running', 'cancelling']
  else if (show) filter.state = [show]
  return filter
}
