// Separation over time: nominal and worst flight, the criterion with its shaded side, the closest approaches.
import { useMemo } from 'react'
import { ChartCard } from '../../charts/ChartCard'
import { type Key, Legend, useHidden } from '../../charts/Legend'
import { Plot, type Standing } from '../../charts/Plot'
import { linesOn, union } from '../../charts/series'
import type { PlotSpec } from '../../charts/spec'
import { counted } from '../../api/queries'
import type { FlightAnswer, TraceData } from '../../client'
import { decimalsFor, exact, fixed } from '../../format/numbers'
import { type Shown, WindowSeg } from '../../ui/WindowSeg'
import { calledOf } from '../data/chosen'
import type { RunData } from '../data/data'
import { curveOf, extentOf, firstOf, noiseOf, spanOf, TIME } from './flown'
import { useAddress } from '../data/useAddress'

export interface Flown {
  key: string
  label: string
  colour: string
  trace: TraceData
}

/** The nominal flight and the chosen one, if available. */
export function flownOf({
  nominalTrace,
  findingTrace,
  chosen,
  run,
}: Pick<RunData, 'nominalTrace' | 'findingTrace' | 'chosen' | 'run'>): Flown[] {
  const pair = [
    { key: 'nominal', label: 'Nominal', colour: '--c-nom', trace: nominalTrace },
    { key: 'worst', label: calledOf({ run, chosen }), colour: '--c-worst', trace: findingTrace },
  ]
  return pair.flatMap(({ trace, ...rest }) => (trace ? [{ ...rest, trace }] : []))
}

/** The what-if flight as another curve; empty without motion. */
export function whatIfOf(answer: FlightAnswer | null): Flown[] {
  if (!answer || Object.keys(answer.data).length === 0) return []
  const { trace: meta, columns, data } = answer
  const rows = data[columns[0]?.name ?? '']?.length ?? 0
  return [{ key: 'what-if', label: 'What-if', colour: '--c-what-if', trace: counted({ name: 'what-if', rows, columns, meta, data }) }]
}

/** The time range of all charts over time. */
export function useShown(id: string): [Shown, (shown: Shown) => void] {
  const [{ time }, change] = useAddress(id)
  return [time ?? 'encounter', (shown) => change({ time: shown === 'all' ? 'all' : undefined })]
}

interface SeparationProps {
  data: RunData
  className: string | undefined
  height: number
  /** Called with the time under the pointer [s], which the 3D view shows. */
  onCross: (time: number) => void
  /** The displayed time: position of the crosshair while no pointer is on a chart. */
  standing: Standing
  /** The criterion does not compute the distance that its component declares. */
  mismeasured?: boolean
  /** The result of the open what-if. */
  whatIf?: FlightAnswer | null
}

export function SeparationCard({ data, className, height, onCross, standing, mismeasured = false, whatIf = null }: SeparationProps) {
  const { run } = data
  const [shown, setShown] = useShown(run.id)
  const [hidden, toggle] = useHidden()
  const { nominalTrace, findingTrace, chosen } = data
  const { threshold, unit } = run
  const measured = (mismeasured ? undefined : run.criteria[0]?.measured_to) ?? ''
  const spec = useMemo(() => {
    const flown = [...flownOf({ nominalTrace, findingTrace, chosen, run }), ...whatIfOf(whatIf)]
    return specOf(flown, { threshold, unit, measured }, shown, height)
  }, [nominalTrace, findingTrace, chosen, run, whatIf, threshold, unit, measured, shown, height])
  const noises = flownOf(data).flatMap(({ label, trace }) => (noiseOf(trace) ? [`${label}: ${noiseOf(trace)}`] : []))
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
      note={[...noises, `${ENDS[measured].note}The 3D view follows the pointer`].join('. ')}
      className={className}
      id="separation"
      run={run.id}
      data={table}
      right={
        <>
          <Legend keys={keys} hidden={hidden} onToggle={toggle} />
          <WindowSeg label="Time shown" value={shown} onChange={setShown} />
        </>
      }
    >
      <Plot spec={spec} hidden={hidden} onCross={onCross} standing={standing} />
    </ChartCard>
  )
}

/** The meaning of the criterion's distances, by their reference point on an obstacle. */
const ENDS = {
  '': { note: '', axis: 'Value of the criterion' },
  centre: { note: "Distance to the nearest obstacle's centre. ", axis: 'Separation from centres' },
  surface: { note: "Distance to the nearest obstacle's surface, negative inside. ", axis: 'Separation from surfaces' },
}

interface Judged {
  threshold: number | null
  unit: string
  measured: keyof typeof ENDS
}

function specOf(all: Flown[], { threshold, unit, measured }: Judged, shown: Shown, height: number): PlotSpec {
  const drawn = all.map((flown) => ({ ...flown, curve: curveOf(flown.trace, firstOf(flown.trace, 'separation')) }))
  const xs = union(drawn.map(({ curve }) => curve))
  const decimals = decimalsFor([Math.min(...drawn.flatMap(({ trace }) => trace.meta.closest?.value ?? []))])
  const points = drawn.flatMap(({ key, label, colour, trace }) => {
    const { closest } = trace.meta
    if (!closest) return []
    const words = `${label} ${fixed(closest.value, decimals)} ${unit} at ${fixed(closest.time, 2)} s`
    return [{ x: closest.time, y: closest.value, colour, label: words, line: key }]
  })
  const xRange = spanOf(
    drawn.map(({ trace }) => trace),
    threshold,
    shown,
  )
  const extent = extentOf(
    drawn.map(({ curve }) => curve),
    xRange,
  )
  const ends = [0, ...(extent ?? []), threshold ?? 0]
  const [bottom, top] = [Math.min(...ends), Math.max(...ends)]
  return {
    label: `Separation over time, ${drawn.map(({ label }) => label.toLowerCase()).join(' and ')} flight, with the criterion`,
    x: xs,
    lines: drawn.map(({ key, label, colour, curve }) => ({ key, label, colour, y: linesOn(xs, curve), width: 1.8 })),
    points,
    yTitle: `${ENDS[measured].axis}, ${unit}`,
    xTitle: 'Time since start, s',
    xRange,
    // Distances to surfaces are negative inside an obstacle.
    yRange: [1.04 * bottom, 1.04 * top || (bottom < 0 ? 0 : 1)],
    criterion:
      threshold === null
        ? undefined
        : { value: threshold, label: `Criterion, ${exact(threshold)} ${unit}`, tint: true, right: true },
    height,
    sync: TIME,
    xText: (x) => `${fixed(x, 2)} s`,
    yText: (y) => `${fixed(y, decimals)} ${unit}`,
  }
}
