// The evaluations of all stages as columns for charts, and their selection by ranges on the axes.
import type { CriterionOut, Evaluations, EvaluationSeries } from '../../client'
import { padded } from '../../charts/ticks'

export interface Axis {
  /** A parameter's path, `VALUE`, or the name of a further criterion. */
  key: string
  /** The worse direction of a further criterion. */
  worse?: 'low' | 'high'
  symbol: string
  unit: string
  text: string
  low: number
  high: number
}

/** Key of the axis of the criterion's value. */
export const VALUE = 'value'

/** The evaluations of one stage. */
export interface Group {
  key: string
  title: string
  method: string | null
  /** Total number, and number drawn. */
  total: number
  shown: number
}

export const FATES = ['ok', 'failed', 'excluded'] as const
export type Fate = (typeof FATES)[number]

export interface Space {
  /** The value first, then the further criteria, then the parameters. */
  axes: Axis[]
  groups: Group[]
  /** By axis; the value of a failed or excluded evaluation is NaN. */
  columns: Float64Array[]
  /** Index in `FATES`; a timeout counts as failed. */
  fates: Uint8Array
  /** Index in `groups`. */
  of: Uint16Array
  /** Counted from 0 within the stage. */
  index: Uint32Array
  /** The noise seed of an evaluation that drew its own; null for those of the campaign. */
  seeds: (number | null)[]
  count: number
  total: number
  stored: number
}

/** From and to on an axis, by its key. */
export type Brush = Readonly<Record<string, readonly [number, number]>>

interface Source {
  evaluations: Evaluations
  axes: readonly Axis[]
  titleOf: (series: EvaluationSeries) => string
  most: number
}

/** At most about `most` evaluations, in proportion to the stages, with the lowest of each. */
export function spaceOf({ evaluations, axes, titleOf, most }: Source): Space {
  const stages = evaluations.stages.filter((series) => axes.every(({ key }) => key === VALUE || columnOf(series, key)))
  const there = stages.reduce((sum, series) => sum + series.index.length, 0)
  const rows = stages.map((series) => thinned(series.cost, Math.ceil((series.index.length * most) / Math.max(there, most))))
  const count = rows.reduce((sum, chosen) => sum + chosen.length, 0)
  const space: Space = {
    axes: [...axes],
    groups: stages.map((series, i) => ({
      key: String(series.position),
      title: titleOf(series),
      method: series.method,
      total: series.total,
      shown: rows[i]?.length ?? 0,
    })),
    columns: axes.map(() => new Float64Array(count)),
    fates: new Uint8Array(count),
    of: new Uint16Array(count),
    index: new Uint32Array(count),
    seeds: new Array<number | null>(count).fill(null),
    count,
    total: stages.reduce((sum, series) => sum + series.total, 0),
    stored: stages.reduce((sum, series) => sum + series.stored, 0),
  }
  let at = 0
  stages.forEach((series, group) => {
    for (const row of rows[group] ?? []) {
      const cost = series.cost[row] ?? Number.NaN
      axes.forEach(({ key }, k) => {
        const column = space.columns[k] as Float64Array
        column[at] = key === VALUE ? cost : (columnOf(series, key)?.[row] ?? Number.NaN)
      })
      space.fates[at] = series.status[row] === 'ok' ? 0 : series.status[row] === 'excluded' ? 2 : 1
      space.of[at] = group
      space.index[at] = series.index[row] ?? 0
      space.seeds[at] = series.seeds[row] ?? null
      at++
    }
  })
  return space
}

/** A stage's column of a parameter or a further criterion; only paths contain dots. */
const columnOf = (series: EvaluationSeries, key: string): readonly (number | null)[] | undefined =>
  series.parameters[key] ?? series.further?.[key]

/** At most `most` rows, evenly spread, including the lowest. */
export function thinned(costs: readonly (number | null)[], most: number): number[] {
  if (costs.length <= most) return costs.map((_, i) => i)
  const chosen = new Set<number>()
  const even = Math.max(1, most - 1)
  for (let i = 0; i < even; i++) chosen.add(Math.round((i * (costs.length - 1)) / Math.max(1, even - 1)))
  const lowest = lowestOf(costs)
  if (lowest >= 0) chosen.add(lowest)
  return [...chosen].sort((a, b) => a - b)
}

function lowestOf(costs: readonly (number | null)[]): number {
  let at = -1
  costs.forEach((cost, i) => {
    if (cost !== null && (at < 0 || cost < (costs[at] ?? Number.POSITIVE_INFINITY))) at = i
  })
  return at
}

/** The selected evaluations: within all ranges, and of stages and statuses that are switched on. */
export function keptOf(space: Space, brush: Brush, hidden: ReadonlySet<string>): Uint32Array {
  const ranges = space.axes.flatMap(({ key }, k) => {
    const range = brush[key]
    return range ? [{ column: space.columns[k] as Float64Array, low: range[0], high: range[1] }] : []
  })
  const groups = space.groups.map(({ key }) => !hidden.has(key))
  const fates = FATES.map((fate) => !hidden.has(fate))
  const kept = new Uint32Array(space.count)
  let n = 0
  for (let i = 0; i < space.count; i++) {
    if (!groups[space.of[i] as number] || !fates[space.fates[i] as number]) continue
    // An evaluation without a value is outside every range of the value.
    if (ranges.every(({ column, low, high }) => (column[i] as number) >= low && (column[i] as number) <= high)) kept[n++] = i
  }
  return kept.slice(0, n)
}

/** The one with the lowest value; null if none has a value. */
export function worstOf(space: Space, kept: Uint32Array): number | null {
  const values = space.columns[0] as Float64Array
  let worst: number | null = null
  for (const i of kept) {
    const value = values[i] as number
    if (!Number.isNaN(value) && (worst === null || value < (values[worst] as number))) worst = i
  }
  return worst
}

/** The parameters of an evaluation by path, to the last bit. */
export const parametersAt = ({ axes, columns }: Space, at: number): Record<string, number> =>
  Object.fromEntries(parametersOf(axes).map((k) => [(axes[k] as Axis).key, columns[k]?.[at] as number]))

/** The first of the selected evaluations with exactly these parameters and this noise seed; null if there is none. */
export function evaluationOf(space: Space, kept: Uint32Array, values: Readonly<Record<string, number>>, seed: number | null): number | null {
  const wanted = parametersOf(space.axes).map((k) => [space.columns[k] as Float64Array, values[(space.axes[k] as Axis).key]] as const)
  return kept.find((i) => space.seeds[i] === seed && wanted.every(([column, value]) => column[i] === value)) ?? null
}

/** The selected evaluation `step` ranks above another one by value, those without a value last; stays at the ends. */
export function rankedFrom(space: Space, kept: Uint32Array, at: number, step: 1 | -1): number {
  const values = space.columns[0] as Float64Array
  const size = (i: number) => (Number.isNaN(values[i]) ? Infinity : (values[i] as number))
  const order = [...kept].sort((a, b) => (size(a) === size(b) ? a - b : size(a) - size(b)))
  return order[order.indexOf(at) + step] ?? at
}

/** The range between two values, clipped to the axis and with rounded ends; null for the whole axis. */
export function rangeOn(axis: Axis, a: number, b: number): readonly [number, number] | null {
  const step = 10 ** Math.floor(Math.log10((axis.high - axis.low) / 300))
  const round = (value: number) => Number((Math.round(value / step) * step).toPrecision(12))
  const low = Math.max(axis.low, round(Math.min(a, b)))
  const high = Math.min(axis.high, round(Math.max(a, b)))
  return low <= axis.low && high >= axis.high ? null : [low, high]
}

/** Encodes a brush for the address: `path:from:to` for each axis. */
export const brushTexts = (brush: Brush): string[] =>
  Object.entries(brush).map(([key, [from, to]]) => `${key}:${from}:${to}`)

/** Parses the brush of an address; invalid ranges are ignored. */
export function brushOf(texts: readonly string[], axes: readonly Axis[]): Brush {
  const found: Record<string, readonly [number, number]> = {}
  for (const text of texts) {
    const [key, from, to] = text.split(':')
    const axis = axes.find((each) => each.key === key)
    const [low, high] = [Number(from || Number.NaN), Number(to || Number.NaN)]
    if (axis && low <= high && high >= axis.low && low <= axis.high) found[axis.key] = [low, high]
  }
  return found
}

/** Sets or removes the range of one axis in a brush. */
export function brushed(brush: Brush, axis: Axis, range: readonly [number, number] | null): Brush {
  const { [axis.key]: before, ...rest } = brush
  if (range) return { ...rest, [axis.key]: range }
  return before ? rest : brush
}

/** Moves one end of a range by a hundredth (or ten) of the axis, or to its bound; ends do not cross. */
export function nudged(axis: Axis, range: readonly [number, number], end: 0 | 1, key: string): [number, number] | null {
  const step = (axis.high - axis.low) / 100
  const steps: Record<string, number> = {
    ArrowUp: 1,
    ArrowRight: 1,
    ArrowDown: -1,
    ArrowLeft: -1,
    PageUp: 10,
    PageDown: -10,
    Home: Number.NEGATIVE_INFINITY,
    End: Number.POSITIVE_INFINITY,
  }
  const by = steps[key]
  if (by === undefined) return null
  const [from, to] = range
  return end === 0
    ? [Math.min(Math.max(from + by * step, axis.low), to), to]
    : [from, Math.max(Math.min(to + by * step, axis.high), from)]
}

/** The position of a value on its axis: 0 at the low end, 1 at the high end. */
export const shareOf = (axis: Axis, value: number): number => (value - axis.low) / (axis.high - axis.low || 1)

export const valueAt = (axis: Axis, share: number): number =>
  axis.low + Math.min(1, Math.max(0, share)) * (axis.high - axis.low)

/** The value's axis: all values, and the criterion unless it is too far away. */
export function valueAxis(evaluations: Evaluations, symbol: string, unit: string, threshold: number | null): Axis {
  const costs = evaluations.stages.flatMap((series) => series.cost.filter((cost) => cost !== null))
  const [low, high] = padded(costs, 0.02)
  const near = threshold !== null && threshold > low - (high - low) && threshold < high + (high - low)
  const range = near ? padded([...costs, threshold], 0.02) : [low, high]
  return { key: VALUE, symbol, unit, text: '', low: range[0] as number, high: range[1] as number }
}

/** The axis of a further criterion: all its values. */
export function criterionAxis(evaluations: Evaluations, criterion: CriterionOut): Axis {
  const { name, title, quantity, unit, worse } = criterion
  const values = evaluations.stages.flatMap((series) => (series.further[name] ?? []).filter((value) => value !== null))
  const [low, high] = padded(values, 0.02)
  return { key: name, symbol: quantity || title, unit, text: title, low, high, worse }
}

/** Indices of the parameters among the axes: after the value and the further criteria. */
export const parametersOf = (axes: readonly Axis[]): number[] =>
  axes.flatMap((axis, k) => (k === 0 || axis.worse ? [] : [k]))
