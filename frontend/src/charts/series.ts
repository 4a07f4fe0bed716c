// Resamples curves to common abscissae, as uPlot requires.

/** The positions of values without a neighbour: a line does not show them. */
export const alone = (y: readonly (number | null | undefined)[]): number[] =>
  y.flatMap((value, k) => (value != null && y[k - 1] == null && y[k + 1] == null ? [k] : []))

export interface Curve {
  x: readonly number[]
  y: readonly (number | null)[]
}

/** All abscissae, ascending, each once. */
export function union(curves: readonly Curve[]): number[] {
  const all = new Set<number>()
  for (const curve of curves) for (const x of curve.x) all.add(x)
  return [...all].sort((a, b) => a - b)
}

/** A step curve on common abscissae; undefined outside its own range. */
export function stepsOn(xs: readonly number[], curve: Curve): (number | null)[] {
  const end = curve.x[curve.x.length - 1] ?? Number.NEGATIVE_INFINITY
  let at = -1
  return xs.map((x) => {
    while (at + 1 < curve.x.length && (curve.x[at + 1] as number) <= x) at++
    return at < 0 || x > end ? null : (curve.y[at] ?? null)
  })
}

/** A linearly interpolated curve on common abscissae; its own points as they are; undefined outside its own range. */
export function linesOn(xs: readonly number[], curve: Curve): (number | null)[] {
  let at = 0
  return xs.map((x) => {
    while (at + 1 < curve.x.length && (curve.x[at + 1] as number) < x) at++
    const x0 = curve.x[at]
    const x1 = curve.x[at + 1]
    if (x0 === undefined || x < x0) return null
    const y0 = curve.y[at]
    const y1 = curve.y[at + 1]
    if (x === x0) return y0 ?? null
    if (x1 === undefined) return null
    if (x === x1) return y1 ?? null
    if (y0 === null || y0 === undefined || y1 === null || y1 === undefined) return null
    return y0 + ((y1 - y0) * (x - x0)) / (x1 - x0)
  })
}
