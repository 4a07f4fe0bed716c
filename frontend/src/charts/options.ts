// Converts a `PlotSpec` to uPlot's options. The spec is read through a getter, so that new data need no new plot.
import uPlot from 'uplot'
import { plain } from '../format/numbers'
import { colour, drawCriteria, drawEnds, drawPoints, drawRules, drawTint, font } from './draw'
import { alone } from './series'
import type { PlotSpec } from './spec'
import { labelWidth, linearTicks, logTicks, padded, tickText } from './ticks'

/** Labels of times: the step from which on they apply [s], the usual one, and those where year, month or day change. */
const TIMES: uPlot.Axis.Values = [
  [365 * 86_400, '{YYYY}', null, null, null, null, null, null, 0],
  [28 * 86_400, '{MMM}', '{MMM} {YYYY}', null, null, null, null, null, 0],
  [86_400, '{D} {MMM}', '{D} {MMM} {YYYY}', null, null, null, null, null, 0],
  [60, '{HH}:{mm}', null, null, '{D} {MMM} {HH}:{mm}', null, null, null, 0],
  [0.001, '{HH}:{mm}:{ss}', null, null, '{D} {MMM} {HH}:{mm}:{ss}', null, null, null, 0],
]

/** Of a line, points only where a value has no neighbour. */
const onlyAlone: uPlot.Series.Points.Filter = (u, series) => alone(Array.from(u.data[series] ?? []))

const stepped = uPlot.paths.stepped?.({ align: 1 })

/** The range of y: what is visible, and the criterion. */
export function rangeOf(spec: PlotSpec, hidden: ReadonlySet<string>): [number, number] {
  if (spec.yRange) return spec.yRange
  const values: number[] = []
  for (const line of spec.lines) if (!hidden.has(line.key)) for (const y of line.y) if (y !== null) values.push(y)
  if (spec.criterion) values.push(spec.criterion.value)
  return padded(values)
}

function domainOf(spec: PlotSpec): [number, number] {
  if (spec.xRange) return spec.xRange
  const low = spec.x[0] ?? (spec.xLog ? 1 : 0)
  const high = spec.x[spec.x.length - 1] ?? low
  return high > low ? [low, high] : [low, spec.xLog ? low * 10 : low + 1]
}

export function optionsFor(
  read: () => PlotSpec,
  hidden: () => ReadonlySet<string>,
  width: number,
  onCursor: (u: uPlot) => void,
): uPlot.Options {
  const spec = read()
  const points = () => (read().points ?? []).filter((point) => !point.line || !hidden().has(point.line))
  return {
    width,
    height: spec.height,
    // Ticks at the ends of an axis need room for their labels.
    padding: [8, spec.xTime ? 34 : spec.xTicks ? 22 : 14, 0, 0],
    legend: { show: false },
    cursor: {
      y: false,
      drag: { x: false, y: false },
      points: { size: 7, width: 1.5 },
      sync: spec.sync ? { key: spec.sync, setSeries: false, scales: ['x', null] } : undefined,
    },
    scales: {
      x: { time: spec.xTime ?? false, distr: spec.xLog ? 3 : 1, range: () => domainOf(read()) },
      y: { range: () => rangeOf(read(), hidden()) },
    },
    axes: [axis(read, 'x'), axis(read, 'y')],
    series: [
      {},
      ...spec.lines.map((line) => ({
        stroke: () => colour(line.colour),
        width: line.width ?? 1.6,
        dash: line.dash?.length ? line.dash.map((length) => length * devicePixelRatio) : undefined,
        show: !hidden().has(line.key),
        paths: line.dots ? () => null : line.stepped ? stepped : undefined,
        points: { show: true, size: 5, fill: () => colour(line.colour), width: 0, ...(!line.dots && { filter: onlyAlone }) },
        // Slanted lines on whole pixels are jagged.
        pxAlign: line.stepped ? 1 : 0,
      })),
    ],
    hooks: {
      drawAxes: [(u) => drawTint(u, read())],
      draw: [(u) => drawRules(u, read()), (u) => drawCriteria(u, read()), (u) => drawEnds(u, read()), (u) => drawPoints(u, points(), read().criterion?.value)],
      setCursor: [onCursor],
    },
  }
}

/** The width of the left axis [px]: as requested, unless its labels would be cut. */
function leftOf(width: number | undefined, labels: readonly string[]): number {
  if (width === undefined) return 14 + 6.4 * Math.max(2, ...labels.map((label) => label.length))
  return Math.max(width, 7 + Math.ceil(Math.max(0, ...labels.map(labelWidth))))
}

function axis(read: () => PlotSpec, side: 'x' | 'y'): uPlot.Axis {
  const log = () => side === 'x' && read().xLog === true
  return {
    font: font().replace(/[\d.]+px/, '11px'),
    stroke: () => colour('--ink-3'),
    gap: 6,
    size: side === 'x' ? 26 : (_, values) => leftOf(read().left, values ?? []),
    grid: { show: side === 'y' || log(), stroke: () => colour('--c-grid'), width: 1 },
    ticks: { show: side === 'x', stroke: () => colour('--c-axis'), width: 1, size: 4 },
    border: { show: side === 'x', stroke: () => colour('--c-axis'), width: 1 },
    ...(side === 'x' && read().xTime ? { values: TIMES, space: 110 } : ticks(read, side, log)),
  }
}

function ticks(read: () => PlotSpec, side: 'x' | 'y', log: () => boolean): uPlot.Axis {
  return {
    splits: (u, _, low, high) => {
      const spec = read()
      if (side === 'x' && spec.xTicks) return [...spec.xTicks]
      if (log()) return logTicks(low, high)
      const about = side === 'x' ? Math.max(3, u.width / 95) : (spec.yTicks ?? Math.max(3, u.height / 44))
      const found = linearTicks(low, high, about)
      // A single tick does not show the scale.
      return found.length > 1 ? found : linearTicks(low, high, 2 * about)
    },
    filter: (_, splits) => splits,
    values: (_, splits) => splits.map(log() || (side === 'x' && read().xTicks) ? (tick) => plain(tick) : tickText(splits)),
  }
}
