// The what-if as it stands in the address: which parameters it begins at, what it has otherwise, which noise.
// Start reading at `readWhatIf` and `valuesOf`.
import type { FlightRequest, ViewState } from '../../client'
import type { ChosenSearch } from '../data/chosen'
import { NOMINAL } from '../data/chosen'
import type { RunData, UncertainParameter } from '../data/data'

export interface WhatIf {
  /** A finding's label, or `nominal`. */
  like: string
  /** Values by path, where they are not those of `like`. */
  set: Readonly<Record<string, number>>
  /** The noise seed of an evaluation that it was taken from; null for that of `like`. */
  seed: number | null
}

type Asked = Pick<ChosenSearch, 'whatif' | 'set' | 'noise'>
type Known = Pick<RunData, 'parameters' | 'findings'>

/** Within the bounds but for rounding: a finding at a bound may lie a last digit beyond it, and is kept bit by bit. */
export const within = ({ low, high }: UncertainParameter, value: number): boolean => {
  const slack = 1e-9 * (high - low)
  return low - slack <= value && value <= high + slack
}

const clamped = (parameter: UncertainParameter, value: number): number =>
  within(parameter, value) ? value : Math.min(parameter.high, Math.max(parameter.low, value))

/** What an address asks for; null where it has no what-if open. What the campaign does not have is left out. */
export function readWhatIf({ whatif, set, noise }: Asked, { parameters, findings }: Known): WhatIf | null {
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

/** As it stands in an address: with every digit, so that a copy is the same flight. */
export function written(whatIf: WhatIf | null): Asked {
  if (!whatIf) return { whatif: undefined, set: undefined, noise: undefined }
  const set = Object.entries(whatIf.set).map(([path, value]) => `${path}:${String(value)}`)
  return { whatif: whatIf.like, set: set.length > 0 ? set : undefined, noise: whatIf.seed ?? undefined }
}

/** The values that it begins at, by path. */
export function baseOf(like: string, { parameters, findings }: Known): Record<string, number> {
  const nominal = Object.fromEntries(parameters.map(({ path, nominal }) => [path, nominal]))
  const finding = findings.find(({ label }) => label === like)
  return finding ? { ...nominal, ...finding.parameters } : nominal
}

/** Every uncertain parameter by path, as it is simulated. */
export const valuesOf = (whatIf: WhatIf, known: Known): Record<string, number> => ({
  ...baseOf(whatIf.like, known),
  ...whatIf.set,
})

/** With another value of one parameter; back at what it begins at, it is none. */
export function withValue(whatIf: WhatIf, parameter: UncertainParameter, value: number, known: Known): WhatIf {
  const wanted = clamped(parameter, value)
  const set = { ...whatIf.set, [parameter.path]: wanted }
  if (wanted === baseOf(whatIf.like, known)[parameter.path]) delete set[parameter.path]
  return { ...whatIf, set }
}

/** The request for its flight, drawn in the page's own view. */
export const requestOf = ({ like, set, seed }: WhatIf, view: string): FlightRequest => ({
  like,
  parameters: { ...set },
  view,
  rows: ROWS,
  ...(seed !== null && { seed }),
})

/** Enough for a curve beside those that are stored, and little to send while a slider moves. */
const ROWS = 200

/** Of an evaluation that was chosen in the parameter space: every parameter as the view shows it. */
export function takenFrom(shown: ViewState, { parameters }: Known): WhatIf | null {
  const { what_if: values, what_if_seed: seed, what_if_source: source } = shown
  if (source !== 'space' || !values) return null
  const set = parameters.flatMap(({ path }) => (values[path] === undefined ? [] : [[path, values[path]] as const]))
  return { like: NOMINAL, set: Object.fromEntries(set), seed }
}

/** Steps of a slider over its range. */
export const STEPS = 400

/** A value so many steps further, as arrow keys move it. */
export const stepped = ({ low, high }: UncertainParameter, value: number, steps: number): number =>
  Math.min(high, Math.max(low, value + (steps * (high - low)) / STEPS))
