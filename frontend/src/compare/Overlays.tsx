// The curves of all runs on common axes: separation over time and convergence. Colours keep their meaning, runs are
// distinguished by dashes.
import { useMemo, useState } from 'react'
import { ChartCard } from '../charts/ChartCard'
import { Plot } from '../charts/Plot'
import { type Curve, linesOn, stepsOn, union } from '../charts/series'
import type { Line, PlotSpec, Point } from '../charts/spec'
import type { TraceData } from '../client'
import { count, decimalsFor, exact, fixed } from '../format/numbers'
import { ofUnit } from '../format/units'
import { convergenceOf, searchesOf } from '../run/data/data'
import { curveOf, extentOf, firstOf } from '../run/flight/flown'
import { MethodName } from '../ui/MethodMark'
import { useMethodLook } from '../ui/methods'
import { Sign } from '../ui/Sign'
import { type Shown, WindowSeg } from '../ui/WindowSeg'
import { type Compared, unitOf } from './data'
import { figures } from '../ui/styles'
import styles from './compare.module.css'

export const RunKeys = ({ runs }: { runs: Compared[] }) => (
  <span className={figures.lg}>
    {runs.map(({ letter, dash }) => (
      <span key={letter} className={figures.k}>
        <Dash dash={dash} colour="--ink-2" />
        {letter}
      </span>
    ))}
  </span>
)

const Dash = ({ dash, colour }: { dash: Compared['dash']; colour: string }) => (
  <svg width={26} height={8} aria-hidden="true">
    <path d="M0 4h26" stroke={`var(${colour})`} strokeWidth={2} strokeDasharray={dash.join(' ') || undefined} />
  </svg>
)

interface CardProps {
  runs: Compared[]
  className: string | undefined
}

export interface Drawn {
  /** In words, for legend and tooltip too. */
  key: string
  colour: string
  trace: TraceData
  of: Compared
}

export function SeparationOverlay({ runs, className }: CardProps) {
  const [window, setWindow] = useState<Shown>('encounter')
  const drawn = useMemo(() => runs.flatMap(drawnOf), [runs])
  const spec = useMemo(() => separationSpec(drawn, runs, window), [drawn, runs, window])
  const name = runs.map(({ id }) => id).join('-')
  const table = () => ({
    name: 'separation',
    columns: ['time since start, s', ...spec.lines.map((line) => line.label)],
    rows: spec.x.map((x, i) => [x, ...spec.lines.map((line) => line.y[i] ?? null)]),
  })
  const decimals = decimalsFor(drawn.map(({ trace }) => trace.meta.closest?.value))
  return (
    <ChartCard
      title="Separation over time"
      className={className}
      id="separation"
      run={name}
      data={table}
      right={
        <>
          <RunKeys runs={runs} />
          <WindowSeg label="Time shown" value={window} onChange={setWindow} />
        </>
      }
    >
      <div className={styles.beside}>
        <Plot spec={spec} />
        <ul className={styles.ends}>
          {drawn.map(({ key, colour, trace, of }) => (
            <li key={key}>
              <Dash dash={of.dash} colour={colour} />
              <span>
                {key}
                <small className="sec">
                  {fixed(trace.meta.closest?.value, decimals)} {of.run.unit}
                </small>
              </span>
            </li>
          ))}
        </ul>
      </div>
    </ChartCard>
  )
}

/** The nominal and the worst flight of a run. */
export function drawnOf(of: Compared): Drawn[] {
  const { letter, nominal, worst } = of
  const flights: [string, string, TraceData | undefined][] = [
    ['nominal', '--c-nom', nominal],
    ['worst', '--c-worst', worst],
  ]
  return flights.flatMap(([name, colour, trace]) =>
    trace ? [{ key: `${letter} ${name}`, colour, trace, of }] : [],
  )
}

function separationSpec(drawn: Drawn[], runs: Compared[], window: Shown): PlotSpec {
  const curves = drawn.map(({ trace }) => curveOf(trace, firstOf(trace, 'separation')))
  const xs = union(curves)
  const unit = unitOf(runs) ?? ''
  const thresholds = runs.flatMap(({ run }) => run.threshold ?? [])
  const lowest = Math.min(...drawn.flatMap(({ trace }) => trace.meta.closest?.value ?? []))
  // Each flight's own encounter, so that runs of very different scales can be compared.
  const inside = drawn.flatMap(({ trace, of }, k) => {
    const reach = 2.4 * Math.max(of.run.threshold ?? 0, trace.meta.closest?.value ?? 0)
    const { x, y } = curves[k] as Curve
    return x.filter((_, i) => (y[i] ?? Infinity) <= reach)
  })
  const whole: [number, number] = [xs[0] ?? 0, xs[xs.length - 1] ?? 1]
  const near = inside.length > 2 ? ([Math.min(...inside), Math.max(...inside)] as [number, number]) : whole
  const xRange = window === 'all' ? whole : near
  const [low, high] = extentOf(curves, xRange) ?? [0, 0]
  const [bottom, top] = [Math.min(0, low, ...thresholds), Math.max(0, high, ...thresholds)]
  const decimals = decimalsFor([lowest])
  const points: Point[] = drawn.flatMap(({ key, colour, trace, of }) => {
    const closest = trace.meta.closest
    return closest ? [{ x: closest.time, y: closest.value, colour, line: key, hollow: of.dash.length > 0 }] : []
  })
  const [first, ...further] = [...new Set(thresholds)]
  const criterionText = (limit: number) => {
    const of = runs.filter(({ run }) => run.threshold === limit).map(({ letter }) => letter)
    return `Criterion${further.length > 0 ? ` of ${of.join(', ')}` : ''}, ${exact(limit)} ${unit}`
  }
  return {
    label: `Separation over time of ${drawn.map(({ key }) => key).join(', ')}`,
    x: xs,
    lines: drawn.map(({ key, colour, of }, i): Line => ({ key, label: key, colour, dash: of.dash, width: 1.8, y: linesOn(xs, curves[i] as Curve) })),
    points,
    xRange,
    yRange: [1.04 * bottom, top * 1.04 || (bottom < 0 ? 0 : 1)],
    yTitle: `Separation${ofUnit(unit)}`,
    xTitle: 'Time since start, s',
    criterion: first === undefined ? undefined : { value: first, label: criterionText(first), tint: true },
    criteria: further.map((value) => ({ value, label: criterionText(value), right: true })),
    height: 340,
    xText: (x) => `${fixed(x, 2)} s`,
    yText: (y) => `${fixed(y, decimals)} ${unit}`,
  }
}

/** The searches of all runs that have completed an evaluation. */
export const searchesIn = (runs: Compared[]) =>
  runs.flatMap((of) => {
    const { run, stages, evaluations, catalogue } = of
    return searchesOf({ run, stages, evaluations, catalogue })
      .map((search) => ({ of, search, curve: convergenceOf(search, 'evaluations') }))
      .filter(({ curve }) => curve.x.length > 0)
  })

export function ConvergenceOverlay({ runs, className }: CardProps) {
  const methodLook = useMethodLook()
  const unit = unitOf(runs) ?? ''
  const searches = useMemo(() => searchesIn(runs), [runs])
  const spec = useMemo((): PlotSpec => {
    const xs = union(searches.map(({ curve }) => curve))
    const decimals = decimalsFor(
      searches.flatMap(({ curve }) => curve.y),
      5,
    )
    return {
      label: `Convergence of ${searches.length} searches`,
      x: xs,
      lines: searches.map(({ of, search, curve }): Line => {
        const look = methodLook(search.stage.method)
        return {
          key: `${of.letter} ${search.stage.position}`,
          label: `${of.letter} ${search.title}`,
          colour: look.colour,
          dash: of.dash,
          y: stepsOn(xs, curve),
          stepped: true,
          end: look.shape,
        }
      }),
      yTitle: (
        <>
          Best <Sign text={runs[0]?.run.quantity || 'value'} /> so far{ofUnit(unit)}
        </>
      ),
      xTitle: 'Evaluations of each method (log scale)',
      xLog: true,
      height: 280,
      xText: (x) => `Evaluation ${count(x)}`,
      yText: (y) => `${fixed(y, decimals)} ${unit}`,
    }
  }, [searches, runs, unit, methodLook])
  const table = () => ({
    name: 'convergence',
    columns: ['run', 'method', 'evaluations', `best so far${ofUnit(unit)}`],
    rows: searches.flatMap(({ of, search, curve }) => curve.x.map((x, i) => [of.id, search.title, x, curve.y[i] ?? null])),
  })
  const methods = [...new Map(searches.map(({ search }) => [search.stage.method, search.title]))]
  return (
    <ChartCard
      title="Convergence"
      note="Smallest value found by each method"
      className={className}
      id="convergence"
      run={runs.map(({ id }) => id).join('-')}
      data={table}
      right={<RunKeys runs={runs} />}
    >
      <Plot spec={spec} />
      <div className={figures.lg}>
        {methods.map(([method, title]) => (
          <span key={method} className={figures.k}>
            <MethodName method={method} title={title} />
          </span>
        ))}
      </div>
    </ChartCard>
  )
}
