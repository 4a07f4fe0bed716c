// The estimated effort of a run in words: a number where it is known well enough, otherwise its range.
import type { Estimate, EstimatedStage } from '../client'
import { count, duration } from '../format/numbers'

/** 10 416, or 12 600 to 22 300. */
export const amountOf = ({ evaluations, least, most, near }: Estimate): string => (near ? count(evaluations) : between(count(least), count(most)))

export const stageOf = ({ least, most }: EstimatedStage): string => between(count(least), count(most))

/** About 12 s, or 6.1 s to 11 s; undefined if it is not known. */
export function timeOf({ seconds, seconds_least, seconds_most, near }: Estimate): string | undefined {
  if (seconds === null) return undefined
  return near || seconds_least === null || seconds_most === null
    ? `about ${duration(seconds)}`
    : between(duration(seconds_least), duration(seconds_most))
}

const between = (least: string, most: string): string => (least === most ? most : `${least} to ${most}`)
