// The result of a stage, by its kind or by what it has: the API's results are a union whose members `stage` distinguishes.
import type { Sample, StageDetail } from '../client'
import { STATED_SEED } from '../format/counts'

type Result = NonNullable<StageDetail['result']>
type Kind = Result['stage']
type ResultOf<K extends Kind> = Extract<Result, { stage: K }>

const isOf = <K extends Kind>(result: Result, kind: K): result is ResultOf<K> => result.stage === kind

/** The result of a stage of that kind; null if there is none yet or the stage is of another kind. */
export function resultOf<K extends Kind>(stage: Pick<StageDetail, 'result'> | undefined, kind: K): ResultOf<K> | null {
  const result = stage?.result ?? null
  return result !== null && isOf(result, kind) ? result : null
}

type Having<P extends string, R = Result> = R extends unknown ? (P extends keyof R ? R : never) : never

/** A result with slices through the nominal point. */
export type SlicesResult = Having<'curves'>

/** A result with an estimate of P(violation). */
export type EstimationResult = Having<'alarms'>

/** A result with a region of attraction. */
export type AttractionOfResult = Having<'contradicting'>

const has = <P extends string>(result: Result, property: P): result is Having<P> => property in result

/** The first result that has this property, of whatever kind of stage; null if there is none yet. */
export function resultWith<P extends string>(stages: readonly Pick<StageDetail, 'result'>[], property: P): Having<P> | null {
  for (const { result } of stages) if (result && has(result, property)) return result
  return null
}

/** The random samples of a run: that of its certificate first, then those of its random searches. */
const samples = (stages: readonly Pick<StageDetail, 'result'>[]): Sample[] => [
  ...[resultWith(stages, 'grid')?.sample ?? []].flat(),
  ...stages.flatMap(({ result }) => (result && has(result, 'sample') && result.sample) || []),
]

/** The independent sample of a run: the first that bounds P(violation). */
export const independentSample = (stages: readonly Pick<StageDetail, 'result'>[]): Sample | null =>
  samples(stages).find(({ upper_bound: bound }) => bound !== null) ?? null

/** What a sample is called: one whose seed somebody may have chosen, as that of a search, is no independent one. */
export function sampleTitle(stages: readonly Pick<StageDetail, 'result'>[], sample: Sample): string {
  const certified = resultWith(stages, 'grid')
  const drawn = certified !== null && certified.sample === sample && certified.drawn_at_launch === true
  return drawn && sample.upper_bound !== null ? 'Independent sample' : 'Random sample'
}

/** What to name as the finder of a case that the sample drew: with a stated seed, somebody may have chosen its points. */
export const samplerOf = (stages: readonly Pick<StageDetail, 'result'>[]): string =>
  resultWith(stages, 'grid')?.drawn_at_launch === false ? `a random sample with a ${STATED_SEED}` : 'the independent sample'

/** The independent sample, or else a random one. */
export const randomSample = (stages: readonly Pick<StageDetail, 'result'>[]): Sample | null =>
  independentSample(stages) ?? samples(stages)[0] ?? null
