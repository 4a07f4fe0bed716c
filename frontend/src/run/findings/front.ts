// The Pareto front of a run with several criteria, over all searches.
import type { FrontResult } from '../../api/stages'
import type { FrontCriterion, FrontPoint } from '../../client'

type Fronted = Pick<FrontResult, 'method' | 'title' | 'criteria' | 'front'>

export interface Placed extends FrontPoint {
  method: string
  title: string
}

/** The criteria of a run's searches, the deciding one first; empty if there is only one. */
export function criteriaOf(searches: readonly Fronted[]): FrontCriterion[] {
  const found = searches.find((search) => search.front)?.criteria ?? []
  return found.length > 1 ? found : []
}

/** The non-dominated points, sorted from worst by the first criterion. */
export function frontOf(searches: readonly Fronted[], criteria: readonly FrontCriterion[]): Placed[] {
  const all = searches.flatMap(({ method, title, front }) =>
    (front ?? []).map((point) => ({ point: { ...point, method, title }, costs: costsOf(point, criteria) })),
  )
  // In sorted order no point is dominated by a later one: the first remaining point is on the front.
  let left = all.sort((a, b) => compared(a.costs, b.costs))
  const found: Placed[] = []
  for (let first = left[0]; first; first = left[0]) {
    const { point, costs } = first
    found.push(point)
    left = left.filter((other) => other.costs.some((cost, k) => cost < (costs[k] as number)))
  }
  return found
}

/** An even selection of points, including the first and the last. */
export function someOf<T>(points: readonly T[], most: number): T[] {
  if (points.length <= most) return [...points]
  const at = Array.from({ length: most }, (_, i) => Math.round((i * (points.length - 1)) / (most - 1)))
  return at.map((i) => points[i] as T)
}

/** Lower is worse. */
function costsOf(point: FrontPoint, criteria: readonly FrontCriterion[]): number[] {
  return criteria.map(({ name, worse }) => (worse === 'high' ? -1 : 1) * (point.values[name] ?? Number.NaN))
}

function compared(a: readonly number[], b: readonly number[]): number {
  const at = a.findIndex((cost, k) => cost !== b[k])
  return at < 0 ? 0 : (a[at] as number) - (b[at] as number)
}
