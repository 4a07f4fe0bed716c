// Stored flights as curves over time: available and displayed columns, time range.
import type { Curve } from '../../charts/series'
import type { TraceColumn, TraceData, TraceInfo } from '../../client'
import { fixed, NARROW } from '../../format/numbers'
import { symbolText } from '../../ui/Sign'
import type { Shown } from '../../ui/WindowSeg'
import { extremes } from '../../charts/ticks'

/** Key of the crosshair shared by charts over time. */
export const TIME = 'time'
/** Default number of columns. */
export const MOST_COLUMNS = 6

/** A column of a flight over time; the first one of a group if no name is given. */
export function curveOf(trace: TraceData, name: string): Curve {
  return { x: (trace.data[firstOf(trace, 'time')] ?? []).map((value) => value ?? 0), y: trace.data[name] ?? [] }
}

/** The name of the first column of a group; empty if there is none. */
export const firstOf = (trace: TraceInfo, group: TraceColumn['group']): string =>
  trace.columns.find((column) => column.group === group)?.name ?? ''

/** The displayed time range: all, or where the separation is within twice the larger of criterion and minimum. */
export function spanOf(traces: readonly TraceData[], threshold: number | null, shown: Shown): [number, number] {
  const curves = traces.map((trace) => curveOf(trace, firstOf(trace, 'separation')))
  const times = curves.flatMap((curve) => [curve.x[0] ?? 0, curve.x[curve.x.length - 1] ?? 1])
  const whole: [number, number] = times.length ? [Math.min(...times), Math.max(...times)] : [0, 1]
  if (shown === 'all') return whole
  const lowest = Math.min(...traces.flatMap((trace) => trace.meta.closest?.value ?? []))
  const reach = 2 * Math.max(threshold ?? 0, Number.isFinite(lowest) ? lowest : 0)
  const inside = curves.flatMap((curve) => curve.x.filter((_, i) => (curve.y[i] ?? Number.POSITIVE_INFINITY) <= reach))
  return inside.length > 2 ? [Math.min(...inside), Math.max(...inside)] : whole
}

/** Lowest and highest value of curves between two times; null without values. */
export function extentOf(curves: readonly Curve[], [from, to]: readonly [number, number]): [number, number] | null {
  return extremes(curves.flatMap(({ x, y }) => x.flatMap((at, i) => (at >= from && at <= to ? (y[i] ?? []) : []))))
}

/** All columns over time of a simulator's trace, in the order that it declares. */
const signals = (trace: TraceInfo): TraceColumn[] => trace.columns.filter(({ group }) => group === 'signal')

const SPEEDS = ['m/s', 'rad/s']

/** All speeds and commands of a flight: speeds, then actuation, then demands; every column of a simulator's trace. */
export function overTime(trace: TraceInfo | undefined): TraceColumn[] {
  if (trace && signals(trace).length > 0) return signals(trace)
  const rank = ({ group, unit, name }: TraceColumn): number =>
    group === 'state' ? SPEEDS.indexOf(unit) : name.endsWith('_demand') ? SPEEDS.length + 1 : SPEEDS.length
  const found = (trace?.columns ?? []).filter(
    ({ group, unit }) => group === 'command' || (group === 'state' && SPEEDS.includes(unit)),
  )
  return found.map((column, at) => ({ column, at })).sort((a, b) => rank(a.column) - rank(b.column) || a.at - b.at).map(({ column }) => column)
}

/** The columns given in the address; by default the first speed of each unit and the actuation. */
export function shownColumns(all: readonly TraceColumn[], list: string | undefined): TraceColumn[] {
  const names = list?.split(',') ?? []
  const found = all.filter(({ name }) => names.includes(name))
  if (found.length > 0) return found
  if (all.length <= MOST_COLUMNS) return [...all]
  const first = (column: TraceColumn) =>
    column.group === 'state' && all.find(({ group, unit }) => group === 'state' && unit === column.unit) === column
  if (all.every(({ group }) => group === 'signal')) return all.slice(0, MOST_COLUMNS)
  const moving = all.filter((column) => first(column) || (column.group === 'command' && !column.name.endsWith('_demand')))
  return moving.slice(0, MOST_COLUMNS)
}

/** The text of a simulator's column, else the information of the name beyond the symbol: `omega_demand` with the symbol ω_d is a demand. */
export function wordsOf({ name, symbol, text }: Pick<TraceColumn, 'name' | 'symbol' | 'text'>): string {
  if (text) return text
  const [first = '', ...rest] = name.split('_')
  const same = symbolText(first) === symbolText(symbol).split('_')[0]
  return (same ? rest : [first, ...rest]).join(' ').replace(/\bref\b/, 'reference')
}


/** The number of charts per row that leaves the fewest empty cells. */
export function acrossOf(count: number, most: number): number {
  let best = 1
  for (let across = 1; across <= Math.min(most, count); across++) {
    const empty = (per: number) => (per - (count % per)) % per
    if (Math.ceil(count / across) < Math.ceil(count / best) && empty(across) <= Math.max(empty(best), across / 2)) best = across
  }
  return best
}

/** The vertical distance to the obstacle, if it is a significant part of the distance. */
export function aboveOf(trace: TraceInfo): string | null {
  const { closest, frame } = trace.meta
  const [own, other] = [closest?.position[2], closest?.obstacle_position[2]]
  if (!closest || own === undefined || other === undefined) return null
  const above = (own - other) * (frame === 'ned' ? -1 : 1)
  if (Math.abs(above) < 0.1 * Math.abs(closest.value) || above === 0) return null
  const decimals = Math.abs(above) < 10 ? 1 : 0
  return `${fixed(Math.abs(above), decimals)}${NARROW}m ${above > 0 ? 'above' : 'below'}`
}

/** The noise realisation of a stored flight; empty without noise. */
export function noiseOf(trace: Pick<TraceInfo, 'meta'> | undefined): string {
  const shown = trace?.meta.realisation
  if (!shown) return ''
  return shown.seeds > 1 ? `noise seed ${shown.seed}, the lowest of ${shown.seeds}` : `noise seed ${shown.seed}`
}
