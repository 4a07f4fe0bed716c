// The what-if in the address: reference parameters, changed values, noise seed.
import type { CaseRequest, FlightAnswer, FlightRequest } from '../../client'
import { namesOf } from '../../trends/code'
import { type ChosenSearch, NOMINAL } from '../data/chosen'
import type { RunData, UncertainParameter } from '../data/data'

export interface WhatIf {
  /** A finding's label, or `nominal`. */
  like: string
  /** Values by path that differ from `like`. */
  set: Readonly<Record<string, number>>
  /** The noise seed of the picked evaluation; null for that of `like`. */
  seed: number | null
}

type Address = Pick<ChosenSearch, 'whatif' | 'set' | 'noise'>
type Known = Pick<RunData, 'parameters' | 'findings'>

/** Clips to the bounds with a rounding tolerance: a finding may exceed a bound by a last digit, and stays bit-identical. */
export const within = ({ low, high }: UncertainParameter, value: number): boolean => {
  const slack = 1e-9 * (high - low)
  return low - slack <= value && value <= high + slack
}

const clamped = (parameter: UncertainParameter, value: number): number =>
  within(parameter, value) ? value : Math.min(parameter.high, Math.max(parameter.low, value))

/** Parses an address; null without an open what-if. Unknown parameters are ignored. */
export function readWhatIf({ whatif, set, noise }: Address, { parameters, findings }: Known): WhatIf | null {
  if (whatif === undefined) return null
  const like = findings.some(({ label }) => label === whatif) ? whatif : NOMINAL
  const found: Record<string, number> = {}
  for (const text of set ?? []) {
    const [path = '', value = ''] = text.split(':')
    const parameter = parameters.find((one) => one.path === path)
    if (parameter && value !== '' && Number.isFinite(Number(value))) found[path] = clamped(parameter, Number(value))
  }
  return { like, set: found, seed: noise ?? null }
}

/** Encodes it for an address at full precision, so that a copied link gives the same flight. */
export function written(whatIf: WhatIf | null): Address {
  if (!whatIf) return { whatif: undefined, set: undefined, noise: undefined }
  const set = Object.entries(whatIf.set).map(([path, value]) => `${path}:${String(value)}`)
  return { whatif: whatIf.like, set: set.length > 0 ? set : undefined, noise: whatIf.seed ?? undefined }
}

/** The reference values by path. */
export function baseOf(like: string, { parameters, findings }: Known): Record<string, number> {
  const nominal = Object.fromEntries(parameters.map(({ path, nominal }) => [path, nominal]))
  const finding = findings.find(({ label }) => label === like)
  return finding ? { ...nominal, ...finding.parameters } : nominal
}

/** The simulated values of all uncertain parameters by path. */
export const valuesOf = (whatIf: WhatIf, known: Known): Record<string, number> => ({
  ...baseOf(whatIf.like, known),
  ...whatIf.set,
})

/** Changes one parameter; a value equal to the reference is removed. */
export function withValue(whatIf: WhatIf, parameter: UncertainParameter, value: number, known: Known): WhatIf {
  const wanted = clamped(parameter, value)
  const set = { ...whatIf.set, [parameter.path]: wanted }
  if (wanted === baseOf(whatIf.like, known)[parameter.path]) delete set[parameter.path]
  return { ...whatIf, set }
}

/** The request for its flight, to be drawn in the page's view. */
export const requestOf = ({ like, set, seed }: WhatIf, view: string): FlightRequest => ({
  like,
  parameters: { ...set },
  view,
  rows: ROWS,
  ...(seed !== null && { seed }),
})

/** The request for a case of a simulator, which has no noise seed. */
export function caseOf(whatIf: WhatIf, view: string): CaseRequest {
  const { like, parameters, rows } = requestOf(whatIf, view)
  return { like, parameters, view, rows }
}

/** Up to this time of an evaluation, the what-if of a simulator follows the sliders [s]. */
export const QUICK = 0.3

/** Number of rows: enough for a curve, and little data while a slider moves. */
const ROWS = 200

/** Number of slider steps over the range. */
export const STEPS = 400

/** A value moved by a number of steps, as by arrow keys. */
export const stepped = ({ low, high }: UncertainParameter, value: number, steps: number): number =>
  Math.min(high, Math.max(low, value + (steps * (high - low)) / STEPS))

/** What has changed in the code since the run, as a sentence; empty if nothing has. */
export const otherCodeOf = ({ code_changes: names, code_known: known }: Pick<FlightAnswer, 'code_changes' | 'code_known'>): string => {
  if (names.length > 0) return `Simulated by other code than this run: ${namesOf(names)}.`
  return known ? '' : 'Whether this run had the code installed now is not known.'
}
