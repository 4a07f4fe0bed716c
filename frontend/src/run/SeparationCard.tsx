// Separation over time: nominal and worst flight, the criterion with its forbidden side, the closest approaches.
import { useMemo, useState } from 'react'
import { ChartCard } from '../charts/ChartCard'
import { type Key, Legend, useHidden } from '../charts/Legend'
import { Plot } from '../charts/Plot'
import { type Curve, linesOn, union } from '../charts/series'
import type { PlotSpec, Point } from '../charts/spec'
import type { TraceData } from '../client'
import { decimalsFor, fixed, plain } from '../format/numbers'
import { type Shown, WindowSeg } from '../ui/WindowSeg'
import { calledOf } from './chosen'
import type { RunData } from './data'

interface Drawn {
  key: string
  label: string
  colour: string
  trace: TraceData | undefined
}

interface SeparationProps {
  data: RunData
  className: string
  /** Called with the time under the pointer [s]: the flight is shown at it. */
  onCross: (time: number) => void
}

export function SeparationCard({ data, className, onCross }: SeparationProps) {
  const { run, nominalTrace, findingTrace, chosen } = data
  const called = calledOf(chosen)
  const [window, setWindow] = useState<Shown>('encounter')
  const [hidden, toggle] = useHidden()
  const spec = useMemo(
    () =>
      specOf(
        [
          { key: 'nominal', label: 'Nominal', colour: '--c-nom', trace: nominalTrace },
          { key: 'worst', label: called, colour: '--c-worst', trace: findingTrace },
        ],
        run.threshold,
        run.unit,
        window,
      ),
    [nominalTrace, findingTrace, called, run.threshold, run.unit, window],
  )
  const keys: Key[] = [
    ...spec.lines.map((line) => ({ key: line.key, label: line.label, colour: line.colour })),
    { key: 'criterion', label: 'Criterion', colour: '--c-crit', dashed: true, fixed: true },
  ]
  const table = () => ({
    name: 'separation',
    columns: ['time since start, s', ...spec.lines.map((line) => `${line.label.toLowerCase()}, ${run.unit}`)],
    rows: spec.x.map((x, i) => [x, ...spec.lines.map((line) => line.y[i] ?? null)]),
  })
  return (
    <ChartCard
      title="Separation over time"
      note="Distance to the nearest obstacle's centre. The flight in 3D goes with the pointer"
      className={className}
      id="separation"
      run={run.id}
      data={table}
      right={
        <>
          <Legend keys={keys} hidden={hidden} onToggle={toggle} />
          <WindowSeg label="Time shown" value={window} onChange={setWindow} />
        </>
      }
    >
      <Plot spec={spec} hidden={hidden} onCross={onCross} />
    </ChartCard>
  )
}

function curveOf(trace: TraceData): Curve {
  const name = (group: string) => trace.columns.find((column) => column.group === group)?.name ?? ''
  const x = (trace.data[name('time')] ?? []).map((value) => value ?? 0)
  return { x, y: trace.data[name('separation')] ?? [] }
}

interface Closest {
  time: number
  value: number
}

const closestOf = (trace: TraceData | undefined): Closest | null => {
  const closest = trace?.meta.closest as Partial<Closest> | null | undefined
  return typeof closest?.time === 'number' && typeof closest.value === 'number' ? (closest as Closest) : null
}

function specOf(all: Drawn[], threshold: number | null, unit: string, window: Shown): PlotSpec {
  const drawn = all.flatMap(({ trace, ...rest }) => (trace ? [{ ...rest, trace, curve: curveOf(trace) }] : []))
  const xs = union(drawn.map(({ curve }) => curve))
  const near = drawn.flatMap(({ trace }) => closestOf(trace) ?? [])
  const lowest = Math.min(...near.map((point) => point.value))
  const decimals = decimalsFor([lowest])
  const points: Point[] = drawn.flatMap(({ key, label, colour, trace }) => {
    const closest = closestOf(trace)
    if (!closest) return []
    const words = `${label} ${fixed(closest.value, decimals)} ${unit} at ${fixed(closest.time, 2)} s`
    return [
      {
        x: closest.time,
        y: closest.value,
        colour,
        label: words,
        line: key,
      },
    ]
  })
  // The encounter: as far as separation stays within twice the larger of the criterion and the lowest value.
  const reach = 2 * Math.max(threshold ?? 0, Number.isFinite(lowest) ? lowest : 0)
  const inside = drawn.flatMap(({ curve }) =>
    curve.x.filter((_, i) => (curve.y[i] ?? Number.POSITIVE_INFINITY) <= reach),
  )
  const whole: [number, number] = [xs[0] ?? 0, xs[xs.length - 1] ?? 1]
  const span = inside.length > 2 ? ([Math.min(...inside), Math.max(...inside)] as [number, number]) : whole
  const xRange = window === 'all' ? whole : span
  return {
    label: `Separation over time, ${drawn.map(({ label }) => label.toLowerCase()).join(' and ')} flight, with the criterion`,
    x: xs,
    lines: drawn.map(({ key, label, colour, curve }) => ({ key, label, colour, y: linesOn(xs, curve), width: 1.8 })),
    points,
    yTitle: `Separation between centres, ${unit}`,
    xTitle: 'Time since start, s',
    xRange,
    yRange: [
      0,
      top(
        drawn.map(({ curve }) => curve),
        xRange,
      ),
    ],
    criterion:
      threshold === null
        ? undefined
        : { value: threshold, label: `Criterion, ${plain(threshold)} ${unit}`, tint: true, right: true },
    height: 280,
    xText: (x) => `${fixed(x, 2)} s`,
    yText: (y) => `${fixed(y, decimals)} ${unit}`,
  }
}

function top(curves: Curve[], [from, to]: [number, number]): number {
  let most = 0
  for (const curve of curves)
    curve.x.forEach((x, i) => {
      const y = curve.y[i]
      if (x >= from && x <= to && typeof y === 'number' && y > most) most = y
    })
  return most * 1.04 || 1
}
