// Texts on the numbers of evaluations, failures and exclusions of a run; the counts come from the run itself and are
// therefore the same everywhere.
import type { Outcome, RunSummary, StageProgress } from '../client'
import { atMost, count, probability } from './numbers'

export type Counted = Pick<RunSummary, 'evaluations' | 'failed_evaluations' | 'excluded_evaluations'>

/** 3 failed, 2 excluded; `none failed` if all have a value. */
export function withoutValue({ failed_evaluations: failed, excluded_evaluations: excluded }: Counted): string {
  const parts = [failed > 0 ? `${count(failed)} failed` : 'none failed', excluded > 0 ? `${count(excluded)} excluded` : '']
  return parts.filter(Boolean).join(', ')
}

/** The same for stages, empty if all have a value; for narrow columns. */
export function lossesOf(stages: readonly { failed: number; excluded: number }[]): string {
  const failed = stages.reduce((sum, stage) => sum + stage.failed, 0)
  const excluded = stages.reduce((sum, stage) => sum + stage.excluded, 0)
  return [failed > 0 ? `${count(failed)} failed` : '', excluded > 0 ? `${count(excluded)} excluded` : '']
    .filter(Boolean)
    .join(', ')
}

/** The evaluations that a margin omits; empty if all have a value. */
export function unknownOf({ evaluations, failed_evaluations: failed }: Counted): string {
  if (failed === 0) return ''
  return `${count(failed)} of ${count(evaluations)} evaluations failed and have no margin`
}

/** The fraction of a stage that is done, by what it has left, since excluded samples are drawn again; one that ended by its own rule is complete. */
export const shareOf = ({ state, evaluations, left }: Pick<StageProgress, 'state' | 'evaluations' | 'left'>): number =>
  state === 'done' ? 1 : evaluations / Math.max(1, evaluations + left)

type BoundSource = Outcome['bound_source'] | undefined

export const STATED_SEED = 'stated seed'

/** What a bound on P(violation) rests on, if its seed was not drawn at the launch; empty for an independent sample. */
export const sourceOf = (source: BoundSource): string =>
  source === 'search' ? 'random search' : source === 'certify_stated' ? STATED_SEED : ''

export type Bounded = Partial<Pick<Outcome, 'upper_bound' | 'bound_source' | 'excluded_fraction'>>

/** What a bound rests on, and the draws that it leaves out: it holds only for the others, or counts them as no violations. */
export const conditionsOf = ({ bound_source: source, excluded_fraction: excluded }: Bounded): string =>
  [sourceOf(source), excluded ? `${probability(excluded)} of draws excluded` : ''].filter(Boolean).join(', ')

/** At most 1 %, or "1 %, random search" and "1 %, stated seed", by which nothing is cleared; "1 %, 75 % of draws excluded". */
export const boundText = (bounded: Bounded): string =>
  [atMost(bounded.upper_bound), bounded.upper_bound != null && conditionsOf(bounded)].filter(Boolean).join(', ')

interface Sample {
  samples: number
  violations: number
  failed: number | null
  excluded: number | null
}

/** Of a random sample: failed evaluations, which count as violations, and excluded draws. */
export const lostOf = ({ failed, excluded }: Pick<Sample, 'failed' | 'excluded'>): string =>
  [failed ? `; ${count(failed)} failed and count as violations` : '', excluded ? `; ${count(excluded)} draws excluded` : ''].join('')

/** 9 of 300 samples violate or failed (4 failed); 20 draws excluded. */
export function violatedOf({ samples, violations, failed, excluded }: Sample): string {
  const all = failed !== null && failed > 0 && failed === violations
  const [counts, violate] = violations === 1 ? ['counts as a violation', 'violates'] : ['count as violations', 'violate']
  const how = all ? `failed and ${counts}` : failed ? `${violate} or failed (${count(failed)} failed)` : violate
  return `${count(violations)} of ${count(samples)} ${samples === 1 ? 'sample' : 'samples'} ${how}${excluded ? `; ${count(excluded)} draws excluded` : ''}`
}

/** How many evaluations have a value. */
export const valued = ({ evaluations, failed_evaluations: failed, excluded_evaluations: excluded }: Counted): number =>
  evaluations - failed - excluded
