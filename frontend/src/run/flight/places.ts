// Plan view of flights of several runs on one scale. East is right and north is up.
import type { TraceData, TraceHead } from '../../client'
import { extremes } from '../../charts/ticks'

export interface Place {
  east: number
  north: number
}

/** A position of the flight's own axes: x east and y north, or x north and y east where z is down. */
export function placeOf(position: readonly number[], frame: TraceHead['frame']): Place {
  const [x = 0, y = 0] = position
  return frame === 'ned' ? { east: y, north: x } : { east: x, north: y }
}

/** A column pair of a flight as positions; with `near`, only around the encounter. */
export function trackOf(trace: TraceData, prefix = '', near = false): Place[] {
  const frame = trace.meta.frame
  const xs = trace.data[`${prefix}x`] ?? []
  const ys = trace.data[`${prefix}y`] ?? []
  const [from, to] = near ? encounterOf(trace) : [0, xs.length]
  const track: Place[] = []
  for (let i = from; i < to; i++) {
    const [x, y] = [xs[i], ys[i]]
    if (typeof x === 'number' && typeof y === 'number') track.push(placeOf([x, y], frame))
  }
  return track
}

/** The rows in which the separation is below four times the larger of criterion and minimum, with a margin. */
export function encounterOf(trace: TraceData): [number, number] {
  const values = trace.data.separation ?? []
  const known = values.filter((value): value is number => typeof value === 'number')
  if (known.length === 0) return [0, values.length]
  const far = 4 * Math.max(trace.meta.threshold ?? 0, Math.min(...known))
  const near = values.flatMap((value, i) => (typeof value === 'number' && value <= far ? [i] : []))
  const [first, last] = [near[0] ?? 0, near[near.length - 1] ?? values.length - 1]
  const pad = Math.floor((last - first) / 8)
  return [Math.max(0, first - pad), Math.min(values.length, last + pad + 1)]
}

export interface Scale {
  x: (place: Place) => number
  y: (place: Place) => number
  /** Pixels per metre. */
  ratio: number
  east: [number, number]
  north: [number, number]
}

/** Equal scales that fit all positions into a box of width by height, with margins. */
export function scaleOf(places: readonly Place[], width: number, height: number, left: number, bottom: number): Scale {
  const [e0, e1] = extremes(places.map(({ east }) => east)) ?? [0, 1]
  const [n0, n1] = extremes(places.map(({ north }) => north)) ?? [0, 1]
  const [across, up] = [width - left - 12, height - bottom - 10]
  const metres = Math.max((1.08 * (e1 - e0)) / across, (1.08 * (n1 - n0)) / up, 1e-9)
  const [e, n] = [(e0 + e1) / 2, (n0 + n1) / 2]
  const east: [number, number] = [e - (metres * across) / 2, e + (metres * across) / 2]
  const north: [number, number] = [n - (metres * up) / 2, n + (metres * up) / 2]
  return {
    x: (place) => left + (place.east - east[0]) / metres,
    y: (place) => 10 + (north[1] - place.north) / metres,
    ratio: 1 / metres,
    east,
    north,
  }
}

export interface Body {
  key: string
  at: Place
  radius: number
  /** The required distance from its centre. */
  reach: number
  track: Place[]
}

export interface Drawable {
  key: string
  /** A finding's flight, whose obstacles are drawn. */
  worst: boolean
  trace: TraceData
}

/** The obstacles of the worst flights: moving ones at the closest approach; equal ones once. */
export function bodiesOf(flights: readonly Drawable[]): Body[] {
  const found = new Map<string, Body>()
  for (const { trace, key } of flights.filter(({ worst }) => worst)) {
    const { obstacles, closest, frame } = trace.meta
    obstacles.forEach((obstacle, i) => {
      const met = i === closest?.obstacle
      const position = met ? closest.obstacle_position : obstacle.position
      if (obstacle.moving && !met) return
      const at = placeOf(position, frame)
      const track = obstacle.moving ? trackOf(trace, `obstacle.${i}.`) : []
      const reach = obstacle.free_radius ?? 0
      const name = [at.east.toFixed(3), at.north.toFixed(3), obstacle.radius, reach].join(' ')
      if (!found.has(name)) found.set(name, { key: `${key} ${i}`, at, radius: obstacle.radius, reach, track })
    })
  }
  return [...found.values()]
}

/** Positions as an SVG path; empty for fewer than two. */
export const line = (places: readonly Place[], scale: Scale): string =>
  places.length < 2 ? '' : `M${places.map((p) => `${scale.x(p).toFixed(1)} ${scale.y(p).toFixed(1)}`).join('L')}`
