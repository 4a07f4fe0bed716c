// The state of the run list in the address.
import type { RunFilter } from '../api/calls'
import type { Sort } from './columns'
import { flag, pairs, text, words } from '../format/query'

export const SHOWS = ['cleared', 'violated', 'inconclusive', 'running', 'queued', 'failed', 'cancelled'] as const
export type Show = (typeof SHOWS)[number]

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
  /** What `columns.tsx` knows of them is shown. */
  sort?: string
  cols?: string[]
  /** Initial focus: the search box, if requested from another page. */
  focus?: 'search'
}

/** The filters of the list; clearing them keeps order and columns. */
export const NARROWING = ['q', 'show', 'campaign', 'tag', 'owner', 'method', 'label', 'days', 'since', 'until', 'pinned', 'removed'] as const
export const CLEARED = Object.fromEntries(NARROWING.map((key) => [key, undefined])) as Partial<RunsSearch>

export const isNarrowed = (search: RunsSearch): boolean => NARROWING.some((key) => search[key] !== undefined)

function date(value: unknown): string | undefined {
  const found = text(value)
  return found && /^\d{4}-\d\d-\d\d$/.test(found) && !Number.isNaN(Date.parse(found)) ? found : undefined
}

const columns = (value: unknown): string[] | undefined =>
  typeof value === 'string' ? value.split(',').filter(Boolean) : undefined

/** Parses the address; unknown values are ignored. */
export function readSearch(search: Record<string, unknown>): RunsSearch {
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
    sort: text(search.sort),
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

export function filterOf(search: RunsSearch, sort?: Sort, now = Date.now()): RunFilter {
  const { show, days, since, until, q, campaign, tag, owner, method, label, pinned, removed } = search
  const filter: RunFilter = { q, sort, campaign, tag, owner, method, label, pinned, removed }
  if (days) filter.since = midnight(new Date(now - (days - 1) * DAY))
  if (since) filter.since = midnight(since)
  if (until) filter.until = midnight(until, 1)
  if (show === 'cleared' || show === 'violated' || show === 'inconclusive') filter.verdict = [show]
  else if (show === 'running') filter.state = ['running', 'cancelling']
  else if (show) filter.state = [show]
  return filter
}
