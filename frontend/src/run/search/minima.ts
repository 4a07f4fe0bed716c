// The minima of one search, merged as the findings are.
import type { Compared, FindingDetail, Gathered, Minimum } from '../../client'
import type { UncertainParameter } from '../data/data'

export interface MergedMinimum {
  /** Its lowest descent. */
  lowest: Minimum
  /** Numbers of the descents that ended in it, from 1. */
  descents: number[]
  evaluations: number
  /** The finding in whose basin it is; null if it is in none. */
  finding: string | null
}

/**
 * Descents that ended in the basin of one finding are one minimum, by the test that distinguished the findings; of the others,
 * those closer than that test's distance. Lowest first.
 * `basins`: the finding of each minimum as validation stored it; by distance alone if it stored none.
 */
export function mergedMinima(
  minima: readonly Minimum[],
  basins: readonly (string | null)[],
  findings: readonly FindingDetail[],
  parameters: readonly Pick<UncertainParameter, 'path' | 'low' | 'high'>[],
  distance: number,
): MergedMinimum[] {
  const near = (a: Record<string, number>, b: Record<string, number>) =>
    parameters.every(({ path, low, high }) => Math.abs((a[path] ?? NaN) - (b[path] ?? NaN)) < distance * (high - low || 1))
  const merged: MergedMinimum[] = []
  const order = minima.map((minimum, i) => ({ minimum, i })).sort((a, b) => a.minimum.cost - b.minimum.cost)
  for (const { minimum, i } of order) {
    const finding = basins[i] ?? findings.find((one) => near(one.parameters, minimum.parameters))?.label ?? null
    const known = merged.find((one) =>
      finding === null ? one.finding === null && near(one.lowest.parameters, minimum.parameters) : one.finding === finding,
    )
    if (known) {
      known.descents.push(i + 1)
      known.evaluations += minimum.evaluations
    } else merged.push({ lowest: minimum, descents: [i + 1], evaluations: minimum.evaluations, finding })
  }
  for (const one of merged) one.descents.sort((a, b) => a - b)
  return merged
}

/** The finding of each minimum of a search, as validation stored it; empty in results of earlier versions. */
export const basinsOf = (comparison: readonly Compared[] | undefined, position: number): readonly (string | null)[] =>
  comparison?.find((row) => row.position === position)?.minima ?? []

/** Fraction of every range below which two minima are one. */
export const distanceOf = (gathered: Gathered | null | undefined): number => gathered?.distance ?? 0.03

/** 1, 3 to 7, 9 */
export function rangesText(numbers: readonly number[]): string {
  const runs: [number, number][] = []
  for (const one of numbers) {
    const last = runs.at(-1)
    if (last && one === last[1] + 1) last[1] = one
    else runs.push([one, one])
  }
  return runs.map(([from, to]) => (from === to ? `${from}` : to === from + 1 ? `${from}, ${to}` : `${from} to ${to}`)).join(', ')
}
