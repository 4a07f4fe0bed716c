// How many evaluations a run has, how many of them failed and were excluded, in words; the counts are those of the run
// itself, the same wherever they are shown. Start reading at `withoutValue`.
import type { RunSummary } from '../client'
import { count } from './numbers'

export type Counted = Pick<RunSummary, 'evaluations' | 'failed_evaluations' | 'excluded_evaluations'>

/** 3 failed, 2 excluded; `none failed` where all have a value. */
export function withoutValue({ failed_evaluations: failed, excluded_evaluations: excluded }: Counted): string {
  const parts = [failed > 0 ? `${count(failed)} failed` : 'none failed', excluded > 0 ? `${count(excluded)} excluded` : '']
  return parts.filter(Boolean).join(', ')
}

/** The same of stages, empty where all have a value: for places with little room. */
export function lossesOf(stages: readonly { failed: number; excluded: number }[]): string {
  const failed = stages.reduce((sum, stage) => sum + stage.failed, 0)
  const excluded = stages.reduce((sum, stage) => sum + stage.excluded, 0)
  return [failed > 0 ? `${count(failed)} failed` : '', excluded > 0 ? `${count(excluded)} excluded` : '']
    .filter(Boolean)
    .join(', ')
}

/** What a margin leaves out; empty where every evaluation has a value. */
export function unknownOf({ evaluations, failed_evaluations: failed }: Counted): string {
  if (failed === 0) return ''
  return `${count(failed)} of ${count(evaluations)} evaluations failed and have no margin`
}

/** Of a random sample: flights that failed, which count as violations, and draws that were excluded. */
export const lostOf = ({ failed, excluded }: { failed: number | null; excluded: number | null }): string =>
  [failed ? `, ${count(failed)} of them failed` : '', excluded ? `; ${count(excluded)} draws excluded` : ''].join('')

/** 4 of 300 violate, 4 of them failed; 20 draws excluded. */
export const violatedOf = (sample: { samples: number; violations: number; failed: number | null; excluded: number | null }): string =>
  `${count(sample.violations)} of ${count(sample.samples)} violate${lostOf(sample)}`
