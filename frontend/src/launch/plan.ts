// The geometry of a scenario seen from above, from its parameters alone: nothing is simulated, so an obstacle that gives
// way is shown on the way it means to go. Places are in the picture's axes, x to the right and y up; for axes north,
// east, down that is north up. Start reading at `planOf`.
import type { Campaign } from '../api/campaign'
import type { Catalogue } from '../client'
import { numberOf, parametersOf } from './parameters'

export interface Place {
  x: number
  y: number
}

export interface PlanBody {
  /** A disc with `radius`, or a rectangle turned by `angle` [rad] in the picture. */
  radius: number
  rectangle: { length: number; width: number; angle: number } | null
  /** Its centre at the start. */
  at: Place
  /** Where the centre of a moving one goes, from the start on; empty for one that stands. */
  track: Place[]
}

export interface Plan {
  start: Place
  /** Of the vehicle at the start, from the picture's x axis [rad]. */
  heading: number
  /** Null where the vehicle has no goal but a course. */
  goal: Place | null
  /** The straight way to the goal, or as far as the course leads within the horizon. */
  way: Place[]
  bodies: PlanBody[]
}

type Values = (name: string) => number | null

const POINTS = 64

/** What there is to draw. `catalogue` knows defaults and axes; without it only what the campaign itself says is drawn. */
export function planOf(campaign: Campaign, catalogue: Catalogue | undefined): Plan {
  const { scenario } = campaign
  const known = valuesOf(campaign, catalogue)
  const entry = (role: string, name: string) => catalogue?.components.find((c) => c.role === role && c.name === name)
  const ned = entry('vehicle', scenario.vehicle.component)?.frame === 'ned'
  const map = (x: number, y: number): Place => (ned ? { x: y, y: x } : { x, y })
  const turned = (angle: number): number => (ned ? Math.PI / 2 - angle : angle)
  const horizon = numberOf(scenario.horizon) ?? 0

  const of = (prefix: string): Values => (name) => known.get(`${prefix}.${name}`) ?? null
  const start = of('start')
  const [x, y] = [start('x') ?? 0, start('y') ?? 0]
  const goal = of('goal')
  const hasGoal = goal('x') !== null && goal('y') !== null
  const end = hasGoal ? map(goal('x') ?? 0, goal('y') ?? 0) : null
  const course = hasGoal ? null : ahead(goal, horizon)
  return {
    start: map(x, y),
    heading: turned(start('psi') ?? start('theta') ?? start('heading') ?? 0),
    goal: end,
    way: end ? [map(x, y), end] : course ? [map(x, y), map(x + course.x, y + course.y)] : [],
    bodies: (scenario.obstacles ?? []).map((part, i) => {
      const values = of(`obstacles.${i}`)
      const track = trackOf(values, horizon)
      const [length, width] = [values('length'), values('width')]
      const rectangle =
        length !== null && width !== null ? { length, width, angle: turned(values('angle') ?? 0) } : null
      const moving = entry('obstacle', part.component)?.moving ?? track.length > 1
      const at = track[0] ?? placeOf(values, 'position') ?? { x: 0, y: 0 }
      return {
        radius: values('radius') ?? 0,
        rectangle,
        at: map(at.x, at.y),
        track: moving ? track.map((p) => map(p.x, p.y)) : [],
      }
    }),
  }
}

function valuesOf(campaign: Campaign, catalogue: Catalogue | undefined): Map<string, number> {
  const { start = {}, goal, obstacles = [] } = campaign.scenario
  const groups = [
    ['start', start],
    ['goal', goal],
    ...obstacles.map((part, i) => [`obstacles.${i}`, part.parameters ?? {}] as const),
  ] as const
  const given = groups.flatMap(([prefix, values]) =>
    Object.entries(values ?? {}).map(([name, raw]) => [`${prefix}.${name}`, raw] as const),
  )
  const declared = catalogue ? parametersOf(campaign, catalogue).map((p) => [p.path, p.nominal] as const) : []
  return new Map(
    [...given, ...declared].flatMap(([path, raw]) => {
      const value = numberOf(raw)
      return value === null ? [] : [[path, value] as const]
    }),
  )
}

function placeOf(values: Values, prefix: string): Place | null {
  const [x, y] = [values(`${prefix}.x`), values(`${prefix}.y`)]
  return x === null || y === null ? null : { x, y }
}

/** How far a speed, a heading and a climb lead within a time, seen from above. */
function ahead(values: Values, time: number): Place | null {
  const [speed, heading] = [values('speed'), values('heading')]
  if (speed === null || heading === null) return null
  const reach = speed * time * Math.cos(values('climb') ?? 0)
  return { x: reach * Math.cos(heading), y: reach * Math.sin(heading) }
}

/** The way of an obstacle by what its parameters are called: a round, waypoints, a goal, a heading or a velocity. */
function trackOf(values: Values, horizon: number): Place[] {
  const round = placeOf(values, 'centre')
  if (round) return roundOf(values, round, horizon)
  const from = placeOf(values, 'position')
  if (!from) return []
  const reach = (values('speed') ?? 0) * horizon
  const legs = Math.round(values('legs') ?? 4)
  const points = Array.from({ length: legs }, (_, i) => placeOf(values, `waypoint${i + 1}`)).filter((p) => p !== null)
  if (points.length > 0) return within([from, ...points], reach)
  const goal = placeOf(values, 'goal')
  if (goal) return within([from, goal], reach)
  const course = ahead(values, horizon)
  if (course) return course.x || course.y ? [from, { x: from.x + course.x, y: from.y + course.y }] : []
  const velocity = placeOf(values, 'velocity')
  if (velocity && (velocity.x || velocity.y))
    return [from, { x: from.x + velocity.x * horizon, y: from.y + velocity.y * horizon }]
  return []
}

/** A round once about its centre at most, from the place at the start. */
function roundOf(values: Values, centre: Place, horizon: number): Place[] {
  const way = values('way') ?? 0
  const phase = values('phase') ?? 0
  const angle = way > 0 ? ((values('speed') ?? 0) * horizon) / way : 0
  const turn = Math.max(-2 * Math.PI, Math.min(2 * Math.PI, angle))
  const count = turn === 0 ? 1 : POINTS
  return Array.from({ length: count }, (_, i) => {
    const at = phase + (count > 1 ? (turn * i) / (count - 1) : 0)
    return { x: centre.x + way * Math.cos(at), y: centre.y + way * Math.sin(at) }
  })
}

/** As much of a way as can be gone. */
function within(points: Place[], reach: number): Place[] {
  const kept = points.slice(0, 1)
  let left = reach
  for (let i = 1; i < points.length && left > 0; i++) {
    const [a, b] = [points[i - 1] as Place, points[i] as Place]
    const length = Math.hypot(b.x - a.x, b.y - a.y)
    const share = length > left ? left / length : 1
    kept.push({ x: a.x + (b.x - a.x) * share, y: a.y + (b.y - a.y) * share })
    left -= length
  }
  return kept
}

export interface Window {
  scale: number
  x: (p: Place) => number
  y: (p: Place) => number
}

/** Fits places into a picture with equal scales, y upwards. `air`: kept free at each side [px]. */
export function fit(points: Place[], width: number, height: number, air: { x: number; y: number }): Window {
  const xs = points.map((p) => p.x)
  const ys = points.map((p) => p.y)
  const [x0, x1] = [Math.min(...xs), Math.max(...xs)]
  const [y0, y1] = [Math.min(...ys), Math.max(...ys)]
  const free = Math.min((width - 2 * air.x) / (x1 - x0), (height - 2 * air.y) / (y1 - y0))
  const scale = Number.isFinite(free) ? free : 1
  return {
    scale,
    x: (p) => width / 2 + (p.x - (x0 + x1) / 2) * scale,
    y: (p) => height / 2 - (p.y - (y0 + y1) / 2) * scale,
  }
}

/** What the picture has to hold. */
export function extentOf(plan: Plan, reach: number): Place[] {
  const around = plan.bodies.flatMap(({ at, radius, rectangle }) => {
    const far = Math.max(reach, radius, rectangle ? Math.hypot(rectangle.length, rectangle.width) / 2 : 0)
    return [
      { x: at.x - far, y: at.y - far },
      { x: at.x + far, y: at.y + far },
    ]
  })
  return [plan.start, ...plan.way, ...around, ...plan.bodies.flatMap((body) => body.track)]
}
