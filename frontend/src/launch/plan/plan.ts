// The geometry of a scenario, from its parameters alone: nothing is simulated, so a cooperative obstacle is shown on
// its intended path. Positions are in the picture's axes, x to the right and y up, with their height; for axes north,
// east, down that is north up.
import type { Campaign } from '../../api/campaign'
import type { Catalogue, ComponentEntry, ObstacleLook } from '../../client'
import { criterionOf, numberOf, parametersOf } from '../campaign/parameters'
import { courseOf, liftOf, placeOf, type Step, type Values, wayLike, wayOf } from './ways'

export interface Place {
  x: number
  y: number
}

export interface PlanBody {
  /** A disc with `radius`, or a rectangle turned by `angle` [rad] in the picture. */
  radius: number
  rectangle: { length: number; width: number; angle: number } | null
  /** Height of a box or a cylinder; null for other shapes. */
  height: number | null
  /** Its centre at the start. */
  at: Step
  /** The path of the centre of a moving obstacle; empty for a static one. */
  track: Step[]
  moving: boolean
}

export interface Plan {
  start: Step
  /** Initial heading of the vehicle from the picture's x axis [rad]. */
  heading: number
  /** Null if the vehicle has a course instead of a goal. */
  goal: Step | null
  /** The straight path to the goal, or along the course up to the horizon. */
  way: Step[]
  bodies: PlanBody[]
  axes: Axes
  /** Whether the criterion measures to the surfaces of obstacles, not to their centres. */
  surface: boolean
  /** Whether the vehicle is spatial, not planar. */
  space: boolean
  horizon: number
}

/** The vehicle's world axes in the picture. */
export interface Axes {
  ned: boolean
  map: (step: Step) => Step
  /** An angle of the vehicle's axes in the picture [rad]. */
  turned: (angle: number) => number
}

export const axesOf = (ned: boolean): Axes => ({
  ned,
  map: (step) => (ned ? { ...step, x: step.y, y: step.x } : step),
  turned: (angle) => (ned ? Math.PI / 2 - angle : angle),
})

/** The plan of a campaign. `catalogue` provides defaults and axes; without it only the campaign's own values are drawn. */
export function planOf(campaign: Campaign, catalogue: Catalogue | undefined): Plan {
  const { scenario } = campaign
  const known = valuesOf(campaign, catalogue)
  const entry = (role: string, name: string) => catalogue?.components.find((c) => c.role === role && c.name === name)
  const vehicle = entry('vehicle', scenario.vehicle.component)
  const axes = axesOf(vehicle?.frame === 'ned')
  const sign = axes.ned ? -1 : 1
  const horizon = numberOf(scenario.horizon) ?? 0

  const of = (prefix: string): Values => (name) => known.get(`${prefix}.${name}`) ?? null
  const start = of('start')
  const from = { x: start('x') ?? 0, y: start('y') ?? 0, up: sign * (start('z') ?? 0) + 0, t: 0 }
  const goal = placeOf(of('goal'), '', sign)
  const avoider = entry('avoider', scenario.avoider.component)
  const end = goal ?? courseOf(of('goal'), from, horizon, liftOf(avoider?.written_in, axes.ned))
  return {
    start: axes.map(from),
    heading: axes.turned(headingOf(vehicle, start)),
    goal: goal && axes.map(goal),
    way: end ? [axes.map(from), axes.map(end)] : [],
    bodies: (scenario.obstacles ?? []).map((part, i) => {
      const values = of(`obstacles.${i}`)
      const known = entry('obstacle', part.component)
      const look = known?.look && 'shape' in known.look ? known.look : undeclared(values, sign)
      const way = wayOf(look.way, values, horizon, sign, liftOf(known?.written_in, axes.ned))
      return bodyOf(look, values, way, known?.moving, axes)
    }),
    axes,
    surface: criterionOf(campaign, catalogue)?.measured_to === 'surface',
    space: vehicle?.dimension === 3,
    horizon,
  }
}

/** The initial state as declared by the vehicle; common names for an unknown vehicle. */
function headingOf(vehicle: ComponentEntry | undefined, start: Values): number {
  if (vehicle?.look && 'mesh' in vehicle.look) return vehicle.look.heading ? (start(vehicle.look.heading) ?? 0) : 0
  return start('psi') ?? start('theta') ?? start('heading') ?? 0
}

/** The look of an obstacle that is unknown or declares none, by common parameter names. */
const undeclared = (values: Values, sign: number): ObstacleLook => ({
  shape: values('length') === null ? 'sphere' : 'box',
  radius: 'radius',
  height: 'height',
  sides: values('length') === null ? [] : ['length', 'width'],
  angle: 'angle',
  way: wayLike(values, sign),
})

function bodyOf(look: ObstacleLook, values: Values, way: Step[], declared: boolean | undefined, axes: Axes): PlanBody {
  const of = (name: string | undefined) => (name ? values(name) : null)
  const [length, width] = [of(look.sides[0]), of(look.sides[1])]
  const angle = axes.turned(of(look.angle) ?? 0)
  const moving = declared ?? way.length > 1
  const place = way[0] ?? placeOf(values, 'position', axes.ned ? -1 : 1) ?? { x: 0, y: 0, up: 0, t: 0 }
  return {
    radius: of(look.radius) ?? 0,
    rectangle: length !== null && width !== null ? { length, width, angle } : null,
    height: of(look.height),
    at: axes.map(place),
    track: moving ? way.map(axes.map) : [],
    moving,
  }
}

/** The nominal values of all position and size parameters. */
export function valuesOf(campaign: Campaign, catalogue: Catalogue | undefined): Map<string, number> {
  const { start = {}, goal, obstacles = [] } = campaign.scenario
  const groups = [
    ['start', start],
    ['goal', goal],
    ...obstacles.map((part, i) => [`obstacles.${i}`, part.parameters ?? {}] as const),
  ] as const
  const own = groups.flatMap(([prefix, values]) =>
    Object.entries(values ?? {}).map(([name, raw]) => [`${prefix}.${name}`, raw] as const),
  )
  const declared = catalogue ? parametersOf(campaign, catalogue).map((p) => [p.path, p.nominal] as const) : []
  return new Map(
    [...own, ...declared].flatMap(([path, raw]) => {
      const value = numberOf(raw)
      return value === null ? [] : [[path, value] as const]
    }),
  )
}

export interface Window {
  scale: number
  x: (p: Place) => number
  y: (p: Place) => number
}

/** Fits positions into a picture with equal scales, y upwards. `air`: margin at each side [px]. */
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

/** The required distance from obstacles' centres or surfaces to a point of the vehicle [m]; 0 for any other criterion. */
export function reachOf(campaign: Campaign, catalogue: Catalogue | undefined): number {
  const { unit, of } = criterionOf(campaign, catalogue) ?? {}
  if (catalogue && (unit !== 'm' || of === 'goal' || of === 'flight')) return 0
  return (numberOf(campaign.criterion.threshold) ?? 0) + (numberOf(campaign.criterion.parameters?.body_radius) ?? 0)
}

/** What a picture of it shows, in words. */
export const describedBy = ({ goal, bodies }: Plan): string =>
  `start, ${goal ? 'goal' : 'course'} and ${bodies.length} ${bodies.length === 1 ? 'obstacle' : 'obstacles'}, ${bodies.filter((body) => body.moving).length} of them moving`

/** The radius about the centre of a round obstacle, or of a rectangle's corners, that must stay free [m]. */
export const freeOf = (body: PlanBody, reach: number, surface: boolean): number =>
  surface && reach > 0 ? (body.rectangle ? 0 : body.radius) + reach : reach

/** The points that the picture must contain. */
export function extentOf(plan: Plan, reach: number): Place[] {
  const around = plan.bodies.flatMap(({ at, radius, rectangle }) => {
    const extent = Math.max(radius, rectangle ? Math.hypot(rectangle.length, rectangle.width) / 2 : 0)
    const far = plan.surface ? extent + reach : Math.max(reach, extent)
    return [
      { x: at.x - far, y: at.y - far },
      { x: at.x + far, y: at.y + far },
    ]
  })
  return [plan.start, ...plan.way, ...around, ...plan.bodies.flatMap((body) => body.track)]
}
