// The estimated effort of a run in words: the bound that no run exceeds, and the time.
import type { Estimate } from '../client'
import { count, duration } from '../format/numbers'

/** At most 24 044: of a run or of a stage. */
export const amountOf = ({ most }: { most: number }): string => `at most ${count(most)}`

/** About 12 s, at most 24 s; undefined if it is not known. */
export function timeOf({ seconds, seconds_most }: Estimate): string | undefined {
  if (seconds === null) return undefined
  return seconds_most === null ? `about ${duration(seconds)}` : `about ${duration(seconds)}, at most ${duration(seconds_most)}`
}
