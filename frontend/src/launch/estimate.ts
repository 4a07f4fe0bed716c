// The estimated effort of a run in words: the usual number, and the bound that no run exceeds.
import type { Estimate, EstimatedStage } from '../client'
import { count, duration } from '../format/numbers'

/** About 10 416, at most 24 044. */
export const amountOf = ({ evaluations, most }: Estimate): string =>
  evaluations === most ? count(most) : `about ${count(evaluations)}, at most ${count(most)}`

export const stageOf = ({ evaluations, most }: EstimatedStage): string =>
  evaluations === most ? count(most) : `${count(evaluations)}, at most ${count(most)}`

/** About 12 s, at most 24 s; undefined if it is not known. */
export function timeOf({ seconds, seconds_most }: Estimate): string | undefined {
  if (seconds === null) return undefined
  return seconds_most === null ? `about ${duration(seconds)}` : `about ${duration(seconds)}, at most ${duration(seconds_most)}`
}
