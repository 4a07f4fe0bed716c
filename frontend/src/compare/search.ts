// The compared runs in the address: /compare?runs=R-0001,R-0002.
import { flag } from '../format/query'

/** Maximum number of compared runs. */
export const MOST = 4

export interface CompareSearch {
  /** Comma-separated ids. */
  runs?: string
  /** Whether equal settings are also shown. */
  all?: boolean
}

export const LETTERS = ['A', 'B', 'C', 'D'] as const

/** Solid, dashed, dotted, dash-dotted: the first run is drawn as on its own page. [px] */
export const DASHES: readonly (readonly number[])[] = [[], [7, 4], [2, 3], [9, 3, 2, 3]]

export function readCompare(search: Record<string, unknown>): CompareSearch {
  const runs = idsOf(search.runs).join(',')
  return { runs: runs || undefined, all: flag(search.all) ?? (search.all === 1 || search.all === '1' || undefined) }
}

/** The unique ids of a text, at most `MOST`. */
export function idsOf(runs: unknown): string[] {
  if (typeof runs !== 'string') return []
  const ids = runs.split(',').filter((id) => /^R-\d{1,15}$/.test(id))
  return [...new Set(ids)].slice(0, MOST)
}

const numberOf = (id: string): number => Number(id.slice(2))

/** The ids from the oldest run to the newest: A is what was before. */
export const olderFirst = (ids: readonly string[]): string[] => [...ids].sort((a, b) => numberOf(a) - numberOf(b))

/** With another run: in the order of the runs, unless that order was changed. */
export const withRun = (ids: readonly string[], id: string): string[] =>
  olderFirst(ids).every((one, i) => one === ids[i]) ? olderFirst([...ids, id]) : [...ids, id]
