// Test fixtures: complete API responses, of which each test overrides the fields that it is about.
import type {
  Coverage,
  FindingDetail,
  RunDetail,
  RunVerdict,
  SearchResult,
  StageDetail,
  StageProgress,
  TraceData,
  TraceHead,
  ValidateResult,
  Validation,
} from '../src/client'
import { words } from '../src/format/spans'

// Without a spread: so a field that the API no longer has is an error, as is a missing one.
const like = <T>(usual: T) => (more: Partial<T> = {}): T => ({ ...usual, ...more })

export const head = like<TraceHead>({
  frame: 'enu', vehicle: 'unicycle', obstacles: [], start: [0, 0, 0], goal: [10, 0, 0], threshold: 1, parameters: {},
  closest: null, status: 'ok', reason: '', cost: null, values: {}, realisation: null,
})

export const flight = like<TraceData>({
  name: 'F1', rows: 0, columns: [], meta: head(), data: {},
})

export const progress = like<StageProgress>({
  position: 0, kind: 'search', own: true, title: 'Search', method: null, state: 'done', planned: 1, evaluations: 1, stored: 1, failed: 0, excluded: 0, best: null,
  best_index: null, seconds: 1, started: 0, finished: 1, so_far: null, left: 0,
})

export const stage = (result: StageDetail['result'], more: Partial<StageDetail> = {}): StageDetail => ({
  ...progress(), ...(result && { kind: result.stage }), result, ...more,
})

export const search = like<SearchResult>({
  stage: 'search', method: 'direct', title: 'DIRECT', kind: 'global', family: '', best: null, evaluations: 1, failed: 0, excluded: 0,
  seconds: 1, stop: null, minima: [], sample: null, gap: null, members: [], criteria: [], front: null, front_size: null,
})

export const validation = like<Validation>({
  name: 'nominal', step: 0.01, cost: 2, half_step: { step: 0.005, cost: 2, difference: 0 },
  integrator: { name: 'DOP853', cost: 2, difference: 0, reason: '' }, allowed: 0.002, ok: true, agrees: true,
  violates: false, realisation: null, neighbours: null,
})

const AGREE = 'the step-halving check and DOP853 agree for nominal'

export const validated = like<ValidateResult>({
  stage: 'validate', ok: true, text: AGREE, statement: [words(AGREE)], tolerance: 1e-3, nominal: validation(),
  findings: null, comparison: [], violations: null, spot_checks: null, encounter: null,
})

const anyFinding = like<FindingDetail>({
  label: '', cost: 0.5, margin: -0.5, granted: 0.5, violates: false, parameters: {}, nominal: {}, low: {}, high: {}, methods: [], found: [], values: {},
  at_bounds: {}, validation: null, slices: null, boundary: null, closest: null, likelihood: null,
})

export const finding = (label: string, more: Partial<FindingDetail> = {}): FindingDetail =>
  anyFinding({ label, validation: validation({ name: label }), ...more })

export const verdict = like<RunVerdict>({
  verdict: 'inconclusive', statement: [], holds_for: [], values: {}, sentence: '', scope: '', not_sampled: false, checks: [], statistics: null, nominal: null, worst: null,
  evaluations: null, quantity: 'd_min', unit: 'm',
  provenance: {
    code: null, loop: null, packages: {}, clearance: null, python: null, system: null, cpu: null, lanes: null, step: null, simulator: null, evaluator: null,
    integrator: null, digest: null, seed: null,
  },
})

const part = (component: string) => ({ component, parameters: {} })

export const run = like<RunDetail>({
  id: 'R-0001', name: '', tags: [], labels: {}, baseline: null, owner: 'Ada', token: null, state: 'done', verdict: null, not_sampled: false, earlier_rules: false, against: '', against_runs: [], not_continuable: null, undigested: null, reason: null, error: null,
  campaign_name: 'a campaign', campaign_digest: '00', quantity: 'd_min', unit: 'm', threshold: 1, nominal_cost: null,
  worst_cost: null, margin: null, worst_method: null, evaluations: 0, planned: 0, failed_evaluations: 0,
  excluded_evaluations: 0, created: 0, started: null, finished: null, stage: null, attempts: 1, worker: null,
  continues: null, pinned: false, best_so_far: [], upper_bound: null, bound_source: null, excluded_samples: null, excluded_fraction: null, policy: null, removed: null, removed_by: null,
  removed_reason: null, group: null, superseded_by: null, notes: '',
  campaign: {
    version: 1, name: 'a campaign', summary: '', notes: '', tags: [],
    scenario: {
      vehicle: part('unicycle'), controller: part('unicycle_speed_heading'), avoider: part('none'), start: {}, goal: {},
      obstacles: [], environment: [], faults: [], horizon: 10, step: 0.01, guidance: { period: 0 },
      realisations: { seeds: [], combine: 'worst' },
    },
    uncertain: {}, correlations: [], criterion: { component: 'separation', parameters: {}, threshold: 1 }, objectives: [],
    stages: {
      sensitivity: null, search: [], certify: null,
      findings: { at_most: 12, evaluations: 1000, distance: 0.01, barrier: 0.01 },
      validate: { tolerance: 1e-3, neighbours: 200, reach: 1e-3 },
    },
    agreement: 0.05, target_probability: null, confidence: 0.95, seed: 1, published: [],
  },
  criteria: [], components_digest: null, flown: null, identity: null, code: null, unidentified: [], plan: [], stages: [], summary: null, rules: '', untraced: '', rate: null, remaining: null, untimed: [], unconfirmed: [], waits: null, other_code: null, doing: null,
})

export const coverage = like<Coverage>({
  total: 1000, used: 1000, without_value: 0, ball: { radius: 0.176, diagonal: 1.414, centre: { 'vehicle.m': 5.5, 'vehicle.J': 0.045 } }, bins: 100,
  pairs: [{ first: 'vehicle.m', second: 'vehicle.J', touched: 34 }],
  possible: { slope: 12.5, fraction: 0.04, standard_error: 0.003, points: 4096 }, statements: [[words('Coverage is no proof.')]],
})
