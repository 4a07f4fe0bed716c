// Uncertain geometry: the bounds of starts, goals, positions and waypoints as boxes, of headings as fans, of radii as
// rings.
import type { Campaign } from '../../api/campaign'
import type { Catalogue } from '../../client'
import { boundsOf, numberOf } from '../campaign/parameters'
import { type Plan, valuesOf } from '../plan/plan'
import { placeOf, type Step } from '../plan/ways'

/** Two opposite corners in the picture's axes; equal in certain coordinates. */
export interface BoxRange {
  path: string
  low: Step
  high: Step
}

export interface FanRange {
  path: string
  at: Step
  /** In the picture [rad], the second one anticlockwise from the first. */
  from: number
  to: number
}

export interface RingRange {
  path: string
  at: Step
  low: number
  high: number
}

export interface Ranges {
  boxes: BoxRange[]
  fans: FanRange[]
  rings: RingRange[]
}

const PLACE = /^((?:start|goal|obstacles\.\d+)(?:\.(?:position|centre|goal|waypoint\d))?)\.([xyz])$/
const HEADING = /^(start|obstacles\.\d+|goal)\.(psi|theta|heading)$/
const RADIUS = /^(obstacles\.\d+)\.radius$/

export function rangesOf(campaign: Campaign, catalogue: Catalogue, plan: Plan): Ranges {
  const known = valuesOf(campaign, catalogue)
  const bounds = new Map<string, [number, number]>()
  for (const [path, uncertain] of Object.entries(campaign.uncertain)) {
    const [low, high] = boundsOf(uncertain, known.get(path) ?? null).map(numberOf)
    if (typeof low === 'number' && typeof high === 'number' && low <= high) bounds.set(path, [low, high])
  }
  const sign = plan.axes.ned ? -1 : 1
  const corner = (prefix: string, which: 0 | 1): Step | null =>
    placeOf((name) => bounds.get(`${prefix}.${name}`)?.[which] ?? known.get(`${prefix}.${name}`) ?? null, '', sign)
  const prefixes = [...new Set([...bounds.keys()].map((path) => PLACE.exec(path)?.[1]).filter((p) => p !== undefined))]
  const boxes = prefixes.flatMap((path) => {
    const [low, high] = [corner(path, 0), corner(path, 1)]
    return low && high ? [{ path, low: plan.axes.map(low), high: plan.axes.map(high) }] : []
  })
  const fans: FanRange[] = []
  const rings: RingRange[] = []
  for (const [path, [low, high]] of bounds) {
    const headed = HEADING.exec(path)?.[1]
    const round = RADIUS.exec(path)?.[1]
    const at = headed && centreOf(plan, headed)
    if (at) {
      const turned = [plan.axes.turned(low), plan.axes.turned(high)].sort((a, b) => a - b)
      fans.push({ path, at, from: turned[0] as number, to: turned[1] as number })
    }
    const centre = round && centreOf(plan, round)
    if (centre) rings.push({ path, at: centre, low, high })
  }
  return { boxes, fans, rings }
}

function centreOf(plan: Plan, prefix: string): Step | undefined {
  const number = /^obstacles\.(\d+)$/.exec(prefix)?.[1]
  return number === undefined ? plan.start : plan.bodies[Number(number)]?.at
}
