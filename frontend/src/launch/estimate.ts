// The estimated effort of a run in words: the bound that no run exceeds, what an earlier run of it took, and the time.
import type { Estimate } from '../client'
import { count, duration } from '../format/numbers'

type Amount = Pick<Estimate, 'evaluations' | 'most'>

/** At most 24 044; after an earlier run of the same campaign 14 515 in R-0001, at most 24 044. */
export const amountOf = ({ run, evaluations, most }: Amount & Pick<Estimate, 'run'>): string =>
  run === null ? atMost(most) : `${count(evaluations)} in ${run}, ${atMost(most)}`

/** The same of one of its stages, without the name of the earlier run; none of a stage that computes without them. */
export function stageAmountOf({ evaluations, most }: Amount, run: string | null): string {
  if (most === 0) return 'none'
  return run === null ? atMost(most) : `${count(evaluations)}, ${atMost(most)}`
}

const atMost = (evaluations: number): string => `at most ${count(evaluations)}`

/** About 12 s, about 24 s with all evaluations; about 12 s without Attraction; undefined if it is not known. */
export function timeOf({ seconds, seconds_most, untimed }: Estimate): string | undefined {
  if (seconds === null) return undefined
  const usual = `about ${duration(seconds)}${untimed.length > 0 ? ` without ${untimed.join(', ')}` : ''}`
  return seconds_most === null ? usual : `${usual}, about ${duration(seconds_most)} with all evaluations`
}
