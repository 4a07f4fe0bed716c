// The path of a non-cooperative obstacle, of the kind declared by its look: a circuit, waypoints, a goal, a
// heading or a velocity. In the vehicle's own axes; `up` is the height.

import type { ObstacleLook } from '../../client'

export type Way = ObstacleLook['way']

/** A position on a path [m], and the time at which it is reached [s]. */
export interface Step {
  x: number
  y: number
  up: number
  t: number
}

/** The value of a parameter; null if there is none of that name. */
export type Values = (name: string) => number | null

/** An angle [rad] in degrees. */
export const degrees = (angle: number): number => (angle * 180) / Math.PI

const POINTS = 64

/** Default motion parameters of an obstacle that declares none. */
export function wayLike(values: Values, sign: number): Way {
  if (placeOf(values, 'centre', sign)) return 'orbit'
  if (placeOf(values, 'waypoint1', sign)) return 'waypoints'
  if (placeOf(values, 'goal', sign)) return 'goal'
  if (values('speed') !== null && values('heading') !== null) return 'heading'
  return placeOf(values, 'velocity', sign) ? 'velocity' : 'still'
}

/** `sign` turns z into height: -1 where z points down. `lift`: what a climb angle does to the height, see `liftOf`. */
export function wayOf(way: Way, values: Values, horizon: number, sign: number, lift: number): Step[] {
  if (way === 'orbit') return roundOf(values, horizon, sign)
  const from = placeOf(values, 'position', sign)
  if (!from || way === 'still') return []
  const speed = values('speed') ?? 0
  if (way === 'waypoints' || way === 'goal') {
    const legs = Math.round(values('legs') ?? 4)
    const names = way === 'goal' ? ['goal'] : Array.from({ length: legs }, (_, i) => `waypoint${i + 1}`)
    return within([from, ...names.map((name) => placeOf(values, name, sign)).filter((p) => p !== null)], speed, horizon)
  }
  if (way === 'heading') {
    const course = courseOf(values, from, horizon, lift)
    return course && (course.x !== from.x || course.y !== from.y || course.up !== from.up) ? [from, course] : []
  }
  const velocity = placeOf(values, 'velocity', sign)
  if (!velocity || !(velocity.x || velocity.y || velocity.up)) return []
  const gone = (at: number, per: number) => at + per * horizon
  const end = { x: gone(from.x, velocity.x), y: gone(from.y, velocity.y), up: gone(from.up, velocity.up), t: horizon }
  return [from, end]
}

/** A position by its coordinates; without a height it is on the ground. */
export function placeOf(values: Values, prefix: string, sign: number): Step | null {
  const name = prefix ? `${prefix}.` : ''
  const [x, y] = [values(`${name}x`), values(`${name}y`)]
  return x === null || y === null ? null : { x, y, up: sign * (values(`${name}z`) ?? 0) + 0, t: 0 }
}

/**
 * Which way a positive climb angle leads: 1 up, -1 down. It goes up in the axes that the component is written for; what
 * flies it in others sinks, and is drawn so. 0 where the component does not say: its height is then known once it is flown.
 */
export function liftOf(writtenIn: string | undefined, ned: boolean): number {
  if (!writtenIn) return ned ? 1 : 0
  return (writtenIn === 'ned') === ned ? 1 : -1
}

/** The end of a path with constant speed, heading and climb angle. */
export function courseOf(values: Values, from: Step, time: number, lift: number): Step | null {
  const [speed, heading] = [values('speed'), values('heading')]
  if (speed === null || heading === null) return null
  const climb = values('climb') ?? 0
  const reach = speed * time * Math.cos(climb)
  return {
    x: from.x + reach * Math.cos(heading),
    y: from.y + reach * Math.sin(heading),
    up: from.up + lift * speed * time * Math.sin(climb),
    t: time,
  }
}

/** A circuit about its centre, at most once, from the start position. */
function roundOf(values: Values, horizon: number, sign: number): Step[] {
  const centre = placeOf(values, 'centre', sign) ?? { x: 0, y: 0, up: 0 }
  const way = values('way') ?? 0
  const phase = values('phase') ?? 0
  const speed = values('speed') ?? 0
  const angle = way > 0 ? (speed * horizon) / way : 0
  const turn = Math.max(-2 * Math.PI, Math.min(2 * Math.PI, angle))
  const time = angle === 0 ? 0 : (horizon * turn) / angle
  const count = turn === 0 ? 1 : POINTS
  return Array.from({ length: count }, (_, i) => {
    const share = count > 1 ? i / (count - 1) : 0
    const at = phase + turn * share
    const up = centre.up + sign * (values('climb') ?? 0) * time * share
    return { x: centre.x + way * Math.cos(at), y: centre.y + way * Math.sin(at), up, t: time * share }
  })
}

/** The part of a path that is covered at a speed within a time. */
function within(points: Step[], speed: number, horizon: number): Step[] {
  const kept = points.slice(0, 1)
  let now = 0
  for (let i = 1; i < points.length && now < horizon && speed > 0; i++) {
    const [a, b] = [points[i - 1] as Step, points[i] as Step]
    const takes = Math.hypot(b.x - a.x, b.y - a.y, b.up - a.up) / speed
    const share = now + takes > horizon ? (horizon - now) / takes : 1
    now += takes * share
    kept.push(between(a, b, share, now))
  }
  return kept
}

const between = (a: Step, b: Step, share: number, t: number): Step => ({
  x: a.x + (b.x - a.x) * share,
  y: a.y + (b.y - a.y) * share,
  up: a.up + (b.up - a.up) * share,
  t,
})

/** The position on a path at a time; null after its end. */
export function at<T extends Step>(way: readonly T[], time: number): Step | null {
  for (let i = 1; i < way.length; i++) {
    const [a, b] = [way[i - 1] as T, way[i] as T]
    if (time >= a.t && time <= b.t) return between(a, b, b.t > a.t ? (time - a.t) / (b.t - a.t) : 0, time)
  }
  return null
}
