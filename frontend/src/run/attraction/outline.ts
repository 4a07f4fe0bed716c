// The boundaries of a section of a region of attraction as points in the units of its two states.
import type { TrimState } from '../../client'

export type Point = readonly [number, number]

/** Distances at even angles, each state relative to its reach; null where a ray has no end. */
export function outline(radii: readonly (number | null)[], x: TrimState, y: TrimState): Point[] {
  return radii.flatMap((r, k) => {
    if (r === null) return []
    const angle = (2 * Math.PI * k) / radii.length
    const point: Point = [x.trim + r * (x.reach ?? 0) * Math.cos(angle), y.trim + r * (y.reach ?? 0) * Math.sin(angle)]
    return [point]
  })
}
