// The nominal flight of the preview, in the picture's axes.
import type { Preview } from '../../client'
import { axesOf } from '../plan/plan'
import type { Step } from '../plan/ways'

export interface Flown {
  path: Step[]
  /** The paths of moving obstacles, by their number. */
  intruders: Map<number, Step[]>
  closest: { at: Step; other: Step; obstacle: number; time: number; value: number; clear: boolean } | null
}

type Column = readonly (number | null)[]

export function flownOf(preview: Preview): Flown {
  const axes = axesOf(preview.frame === 'ned')
  const sign = axes.ned ? -1 : 1
  const steps = (x: Column, y: Column, z: Column): Step[] =>
    preview.t.flatMap((t, i) => {
      const [a, b, c] = [x[i], y[i], z[i]]
      if (typeof t !== 'number' || typeof a !== 'number' || typeof b !== 'number' || typeof c !== 'number') return []
      return [axes.map({ x: a, y: b, up: sign * c + 0, t })]
    })
  const place = ([x = 0, y = 0, z = 0]: number[], t: number): Step => axes.map({ x, y, up: sign * z + 0, t })
  const { closest } = preview
  return {
    path: steps(preview.x, preview.y, preview.z),
    intruders: new Map(preview.intruders.map((one) => [one.obstacle, steps(one.x, one.y, one.z)])),
    closest: closest && {
      at: place(closest.position, closest.time),
      other: place(closest.obstacle_position, closest.time),
      obstacle: closest.obstacle,
      time: closest.time,
      value: closest.value,
      clear: closest.value > preview.threshold,
    },
  }
}
