// The stored nominal flight of a shipped campaign in the picture's axes.
import type { DrawnFlight } from '../../client'
import type { Axes, Place } from './plan'

export interface Nominal {
  path: Place[]
  /** The paths of moving obstacles, by their number. */
  tracks: Map<number, Place[]>
  /** Positions at the closest approach; null if the criterion is not a distance to obstacles. */
  closest: { at: Place; other: Place; obstacle: number } | null
  /** Of moving obstacles, where each is at the closest approach; without one, at the start. */
  moment: Map<number, Place>
}

export function nominalOf(flight: DrawnFlight, axes: Axes): Nominal {
  const place = (x: number, y: number): Place => axes.map({ x, y, up: 0, t: 0 })
  const steps = (x: readonly number[], y: readonly number[]) => x.map((value, i) => place(value, y[i] ?? 0))
  const tracks = new Map(flight.tracks.map((track) => [track.obstacle, steps(track.x, track.y)]))
  const { closest } = flight
  const row = closest ? nearestRow(flight, closest.x, closest.y) : 0
  return {
    path: steps(flight.x, flight.y),
    tracks,
    closest: closest && {
      at: place(closest.x, closest.y),
      other: place(closest.obstacle_x, closest.obstacle_y),
      obstacle: closest.obstacle,
    },
    moment: new Map([...tracks].flatMap(([i, track]) => (track[row] ? [[i, track[row]] as const] : []))),
  }
}

/** The row next to the closest approach, which is between rows. */
function nearestRow({ x, y }: DrawnFlight, atX: number, atY: number): number {
  const away = x.map((value, i) => Math.hypot(value - atX, (y[i] ?? 0) - atY))
  return away.indexOf(Math.min(...away))
}
