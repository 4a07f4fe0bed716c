// The result of a stage by what it has, of whatever kind it is.
import type { Sample, StageDetail } from '../client'
import { STATED_SEED } from '../format/counts'

type Result = NonNullable<StageDetail['result']>
type Having<P extends string, R = Result> = R extends unknown ? (P extends keyof R ? R : never) : never

/** A result with slices through the nominal point. */
export type SlicesResult = Having<'curves'>

/** A result with the minima at which its descents ended. */
export type MinimaResult = Having<'minima'>

/** A result with a Pareto front. */
export type FrontResult = Having<'front'>
/** A result with an estimate of P(violation). */
export type EstimationResult = Having<'alarms'>

/** A result with a region of attraction. */
export type AttractionOfResult = Having<'contradicting'>

const has = <P extends string>(result: Result, property: P): result is Having<P> => property in result

/** The results that have this property, of whatever kinds of stages. */
export const resultsWith = <P extends string>(stages: readonly Pick<StageDetail, 'result'>[], property: P): Having<P>[] =>
  stages.flatMap(({ result }) => (result && has(result, property) ? [result] : []))

/** The first of them; null if there is none yet. */
export const resultWith = <P extends string>(stages: readonly Pick<StageDetail, 'result'>[], property: P): Having<P> | null =>
  resultsWith(stages, property)[0] ?? null

/** The random samples of a run: that of its certificate first, then those of its random searches. */
const samples = (stages: readonly Pick<StageDetail, 'result'>[]): Sample[] => [
  ...[resultWith(stages, 'grid')?.sample ?? []].flat(),
  ...resultsWith(stages, 'sample').flatMap(({ sample }) => sample ?? []),
]

/** The independent sample of a run: the first that bounds P(violation). */
export const independentSample = (stages: readonly Pick<StageDetail, 'result'>[]): Sample | null =>
  samples(stages).find(({ upper_bound: bound }) => bound !== null) ?? null

/** What a sample is called: one whose seed a user may have chosen, as that of a search, is no independent one. */
export function sampleTitle(stages: readonly Pick<StageDetail, 'result'>[], sample: Sample): string {
  const certified = resultWith(stages, 'grid')
  const drawn = certified !== null && certified.sample === sample && certified.drawn_at_launch === true
  return drawn && sample.upper_bound !== null ? 'Independent sample' : 'Random sample'
}

/** What to name as the finder of a case that the sample drew: with a stated seed, a user may have chosen its points. */
export const samplerOf = (stages: readonly Pick<StageDetail, 'result'>[]): string =>
  resultWith(stages, 'grid')?.drawn_at_launch === false ? `a random sample with a ${STATED_SEED}` : 'the independent sample'

/** The independent sample, or else a random one. */
export const randomSample = (stages: readonly Pick<StageDetail, 'result'>[]): Sample | null =>
  independentSample(stages) ?? samples(stages)[0] ?? null
