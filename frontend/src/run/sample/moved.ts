// What sliders can move of the stated distributions, and the request for an estimate under the moved ones.
import type { Raw, Uncertain } from '../../api/campaign'
import type { ReweightRequest } from '../../client'
import { numberOf } from '../../launch/campaign/parameters'
import type { RunData, UncertainParameter } from '../data/data'

export interface Knob {
  parameter: UncertainParameter
  /** Of the distribution, or the bounds of a uniform one. */
  name: 'mean' | 'deviation' | 'mode' | 'alpha' | 'beta' | 'low' | 'high'
  title: string
  stated: number
  low: number
  high: number
}

/** By the path of the parameter and the name of the knob. */
export type Moved = Readonly<Record<string, number>>

export const keyOf = ({ parameter, name }: Pick<Knob, 'parameter' | 'name'>): string => `${parameter.path} ${name}`

const TITLES: Record<Knob['name'], string> = {
  mean: 'mean', deviation: 'standard deviation', mode: 'mode', alpha: 'alpha', beta: 'beta', low: 'lower bound', high: 'upper bound',
}
/** How far scales and shapes move, as multiples of the stated one. */
const [LESS, MORE] = [1 / 3, 2]

/** The ends of a knob: bounds stay within those of the draws, and cannot cross. */
function endsOf({ low, high }: UncertainParameter, name: Knob['name'], stated: number): [number, number] {
  const half = 0.49 * (high - low)
  if (name === 'low') return [low, low + half]
  if (name === 'high') return [high - half, high]
  return name === 'mean' || name === 'mode' ? [low, high] : [LESS * stated, MORE * stated]
}

/** The knobs of all uncertain parameters, in the campaign's order. */
export function knobsOf({ parameters, campaign }: Pick<RunData, 'parameters' | 'campaign'>): Knob[] {
  return parameters.flatMap((parameter) => {
    const { kind = 'uniform', ...rest } = campaign.uncertain[parameter.path]?.distribution ?? {}
    const values: Record<string, Raw | undefined> = kind === 'uniform' ? { low: parameter.low, high: parameter.high } : rest
    return Object.entries(values).flatMap(([key, raw]): Knob[] => {
      const [name, stated] = [key as Knob['name'], numberOf(raw)]
      if (stated === null || !(name in TITLES)) return []
      const [low, high] = endsOf(parameter, name, stated)
      return [{ parameter, name, title: TITLES[name], stated, low, high }]
    })
  })
}

/** The moved distributions as the service takes them; what is not moved stays as stated. */
export function requestOf(knobs: readonly Knob[], moved: Moved, campaign: Pick<RunData['campaign'], 'uncertain'>): ReweightRequest {
  const uncertain: Record<string, Uncertain> = {}
  for (const knob of knobs) {
    const value = moved[keyOf(knob)]
    if (value === undefined || value === knob.stated) continue
    const { path, low, high } = knob.parameter
    const { unit: _, ...stated } = uncertain[path] ?? campaign.uncertain[path] ?? {}
    if (knob.name === 'low' || knob.name === 'high')
      uncertain[path] = { low: stated.low ?? low, high: stated.high ?? high, [knob.name]: value }
    else uncertain[path] = { ...stated, distribution: { kind: '', ...stated.distribution, [knob.name]: value } }
  }
  return { uncertain } as ReweightRequest
}
