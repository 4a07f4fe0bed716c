// The shapes of stage results and of a verdict's parts, which the API passes on as plain JSON.
// Written by `worker/stages`; read here through `resultOf` and `summaryOf` only.
import type { RunDetail, StageDetail } from '../client'

export type Values = Record<string, number>

export interface NominalResult {
  cost: number | null
  margin: number | null
  status: string
  reason: string
  parameters: Values
}

export interface SensitivityCurve {
  path: string
  values: number[]
  costs: (number | null)[]
  status: string[]
}

/** Curves of all parameters through one point, the others as they are there. */
export interface Slices {
  curves: SensitivityCurve[]
  at: Values
}

/** An index study over the whole box; `indices` is null where it was not computed, and `text` says why. */
export interface IndexStudy<Row> {
  evaluations: number
  failed: number
  excluded: number
  confidence: number
  indices: Row[] | null
  text: string
}

/** Per whole range, in the criterion's unit. */
export interface MorrisRow {
  path: string
  mu: number | null
  mu_star: number | null
  mu_star_confidence: number | null
  sigma: number | null
}

/** Shares of the variance, with the half width of their interval. */
export interface SobolRow {
  path: string
  first: number | null
  first_confidence: number | null
  total: number | null
  total_confidence: number | null
}

export interface SensitivityResult {
  points: number
  curves: SensitivityCurve[]
  morris?: (IndexStudy<MorrisRow> & { trajectories: number; levels: number }) | null
  sobol?: (IndexStudy<SobolRow> & { samples: number }) | null
}

export interface Minimum {
  start: Values | null
  parameters: Values
  cost: number
  evaluations: number
  text: string
}

export interface Sample {
  samples: number
  violations: number
  /** Counted among the violations. */
  failed?: number
  /** Draws that start at or below the criterion; they are drawn again. */
  excluded?: number
  /** Whether the flights simulated the noise that the campaign states, or drew one each. */
  noise?: 'none' | 'drawn' | 'stated'
  confidence: number
  /** Null for points that are no independent sample. */
  upper_bound: number | null
  lowest: number | null
  mean: number | null
  deviation: number | null
  histogram: { edges: number[]; counts: number[] } | null
  text: string
  /** Of the certify stage: the lower bound on the quantile at `share`; null where the sample allows none. */
  quantile?: { share: number; order: number | null; bound: number | null; needed: number | null; text: string }
  /** Of the certify stage: the share of the sample at or below each value, and half the width of its band. */
  distribution?: { values: number[]; shares: number[]; band: number }
}

export interface GridResult {
  points: number
  total: number
  spacing: Values
  lowest: { cost: number; margin: number; parameters: Values } | null
  violations: number
  failed: number
  excluded: number
  text: string
}

export interface CertifyResult {
  sample: Sample
  grid: GridResult | null
  text: string
}

/** An estimate, from the slopes that DIRECT saw. */
export interface Gap {
  lower_bound: number
  gap: number
  text: string
}

export interface FrontCriterion {
  /** Told apart where a component is named twice. */
  name: string
  title: string
  quantity: string
  unit: string
  worse: 'low' | 'high'
}

/** A flight of the front; values by the criterion's name, in their own sign. */
export interface FrontPoint {
  index: number
  parameters: Values
  values: Values
}

export interface Member {
  member: string
  title: string
  evaluations: number
  best: number | null
  /** How often it lowered the best of all. */
  improvements: number
}

export interface SearchResult {
  method: string
  title: string
  kind: 'global' | 'local' | 'random' | 'multi'
  best: { cost: number; margin: number; parameters: Values; index: number } | null
  evaluations: number
  failed: number
  excluded: number
  seconds: number
  stop: { kind: 'rule' | 'budget'; text: string } | null
  minima: Minimum[]
  sample: Sample | null
  gap?: Gap | null
  /** Of a portfolio: what each of its methods asked for. */
  members?: Member[]
  criteria?: FrontCriterion[]
  /** Null with one criterion. */
  front?: FrontPoint[] | null
  /** How many flights the front has; `front` may hold fewer. */
  front_size?: number | null
}

export interface ValidationCase {
  name: string
  step: number
  cost: number | null
  half_step: { step: number; cost: number | null; difference: number | null }
  integrator: { name: string; cost: number | null; difference: number | null; reason?: string }
  allowed: number | null
  /** Validated: it agrees or it violates. */
  ok: boolean
  /** Both differences are within tolerance, and all values on the same side of the criterion. */
  agrees?: boolean
  /** Every integration violates, however far they are apart. */
  violates?: boolean
  /** The noise seed that it drew with its flight; null where it simulated those of the campaign. */
  realisation?: number | null
  neighbours: { flown: number; failed: number; lowest: number | null; lower_by: number | null } | null
}

/** A search beside the others, once all findings are known. */
export interface Compared {
  position: number
  method: string
  title: string
  kind: SearchResult['kind']
  best: number | null
  evaluations: number
  failed: number
  excluded: number
  seconds: number
  /** Evaluations until within 1 % of nominal minus worst of the best known; null where it never came there. */
  to_near_best: number | null
  /** The finding whose basin holds its best; null where none does. */
  basin?: string | null
  /** Labels of the findings it came to by itself. */
  findings: string[]
  stop: SearchResult['stop']
}

export interface ValidateResult {
  ok: boolean
  text: string
  tolerance: number
  cases: ValidationCase[]
  findings?: {
    candidates: number
    left_out: number
    complete: boolean
    text: string
    /** Share of every range. */
    distance: number
    /** Share of nominal minus worst. */
    barrier: number
    at_most: number
  }
  comparison?: Compared[]
  /** Violating evaluations of all stages, and how many of those simulated again violate there too. */
  violations?: { stored: number; checked: number; confirmed: number; text: string }
  spot_checks?: SpotChecks
  encounter?: Encounter
  /** By finding, as far as validation came: slices through it, and the boundary of a violation, null where it is none. */
  after?: Record<string, { boundary: { text: string } | null; slices?: Slices }>
}

/** Random evaluations of all stages with the reference integrator. */
export interface SpotChecks {
  checked: number
  compared: number
  /** The distance to the stored value, in the criterion's unit. */
  largest: number | null
  median: number | null
  /** Violate there and not here. */
  violating: number
  /** Where the two are furthest apart. */
  at: {
    position: number
    index: number
    cost: number
    reference: number
    parameters: Values
    realisation: number | null
  } | null
  reasons: string[]
  text: string
}

/** What shows that the avoidance was put to the test. */
export interface Encounter {
  closest: { name: string; time: number | null; at: 'start' | 'inside' | 'end' | 'none'; obstacle?: number }[]
  /** Length of the nominal path [m]. */
  moved: number | null
  /** The nominal case with an avoider that sees no obstacle. */
  unseen: { cost: number | null; status: string; reason: string; deviation: number | null }
  spread: { evaluations: number; lowest: number | null; highest: number | null }
  /** By path: the largest change along any slice. */
  influence: Values
}

/** Which noise realisation a stored flight shows, of how many. */
export interface Realisation {
  seed: number
  seeds: number
  combine: string
  cost: number | null
}

interface ResultByKind {
  nominal: NominalResult
  sensitivity: SensitivityResult
  search: SearchResult
  certify: CertifyResult
  validate: ValidateResult
}

/** The result of a stage of that kind; null while it has none. */
export function resultOf<K extends keyof ResultByKind>(
  stage: StageDetail | undefined | null,
  kind: K,
): ResultByKind[K] | null {
  if (!stage || stage.kind !== kind || !stage.result) return null
  return stage.result as unknown as ResultByKind[K]
}

export interface Check {
  name: string
  /** For people. */
  title: string
  ok: boolean
  /** `open`: it holds for the evaluations that have a value, and others failed. */
  standing: 'holds' | 'open' | 'fails'
  text: string
  /** What limits it; empty unless it is open. */
  but: string
}

export interface Provenance {
  digest?: string
  seed?: number
  clearance?: string
  python?: string
  packages?: Record<string, string>
  system?: string
  cpu?: string | { model?: string; target?: string; features?: string }
  code?: string
  loop?: string
  lanes?: number
  step?: number
  integrator?: string
}

export interface Statistics {
  samples: number
  violations: number
  /** Counted among the violations. */
  failed?: number | null
  excluded?: number | null
  confidence: number
  upper_bound: number
  text: string
}

export interface VerdictParts {
  sentence?: string
  scope?: string
  checks?: Check[]
  statistics?: Statistics | null
  provenance?: Provenance
}

export const summaryOf = (run: RunDetail): VerdictParts => run.summary
