// Sensitivity: each parameter over its bounds, the others nominal or as in the chosen finding; all curves share the
// vertical axis.
import { useMemo } from 'react'
import type { SlicesResult } from '../../api/stages'
import { ChartCard } from '../../charts/ChartCard'
import { type Key, Legend, useHidden } from '../../charts/Legend'
import { Plot } from '../../charts/Plot'
import { useReach } from '../../charts/reach'
import { linesOn, union } from '../../charts/series'
import type { PlotSpec } from '../../charts/spec'
import { padded } from '../../charts/ticks'
import type { Curve, Gathered, Slices } from '../../client'
import { decimalsFor, fixed } from '../../format/numbers'
import { ofUnit, unitText } from '../../format/units'
import { Sign, symbolText } from '../../ui/Sign'
import { calledOf, NOMINAL } from '../data/chosen'
import type { RunData, UncertainParameter } from '../data/data'
import styles from './parameters.module.css'

interface SensitivityCardProps {
  data: RunData
  result: SlicesResult
  /** Whether slices of all findings were simulated. */
  gathered: Gathered | null | undefined
  className: string | undefined
  /** Size of each plot [px]. */
  height: number
}

export function SensitivityCard({ data, result, gathered, className, height }: SensitivityCardProps) {
  const { run, parameters, chosen, finding } = data
  const [hidden, toggle] = useHidden()
  const slices = finding?.slices ?? null
  const called = calledOf(data).replace('Worst', 'worst')
  const drawn = [...result.curves, ...(slices?.curves ?? [])]
  const costs = drawn.flatMap((curve) => curve.costs.filter((cost): cost is number => cost !== null))
  const { criterion, choice, note } = useReach(costs, run.threshold, run.unit, 'these axes')
  const yRange = padded(criterion === null ? costs : [...costs, criterion], 0.1)
  const keys: Key[] = [
    { key: 'nominal', label: 'Others at nominal', colour: '--c-nom' },
    ...(slices ? [{ key: 'worst', label: `Others at ${called}`, colour: '--c-worst' }] : []),
    ...(criterion === null ? [] : [{ key: 'criterion', label: 'Criterion', colour: '--c-crit', dashed: true, fixed: true }]),
  ]
  return (
    <ChartCard
      title={
        <>
          Sensitivity of <Sign text={run.quantity || 'value'} />
        </>
      }
      note={`${run.unit}, ${result.points} points per curve`}
      className={className}
      id="sensitivity"
      run={run.id}
      data={() => tableOf(data, result, slices, called)}
      right={
        <>
          <Legend keys={keys} hidden={hidden} onToggle={toggle} />
          {choice}
        </>
      }
      footer={footerOf(drawn, missing(gathered, chosen, slices))}
    >
      <div className={styles.smalls}>
        {result.curves.map((curve) => {
          const parameter = parameters.find((p) => p.path === curve.path)
          return parameter ? (
            <Small
              key={curve.path}
              data={data}
              curve={curve}
              slices={slices}
              called={called}
              parameter={parameter}
              yRange={yRange}
              criterion={criterion}
              hidden={hidden}
              height={height}
            />
          ) : null
        })}
      </div>
      {note}
    </ChartCard>
  )
}

/** The reason why a finding has no slices: validation ended before. */
function missing(gathered: Gathered | null | undefined, chosen: string, slices: Slices | null): string {
  if (slices || chosen === NOMINAL || !gathered || gathered.complete) return ''
  return `No slices were simulated through ${chosen}: validation ended before them.  `
}

function footerOf(curves: readonly Curve[], absent: string) {
  const failed = curves.reduce((sum, curve) => sum + curve.status.filter((status) => status !== 'ok').length, 0)
  const gaps = failed > 0 ? `${failed} of these evaluations ${failed === 1 ? 'has' : 'have'} no value; the curves have gaps there.` : ''
  return absent || gaps ? absent + gaps : undefined
}

function tableOf({ run }: RunData, result: SlicesResult, slices: Slices | null, called: string) {
  const rows = (curves: readonly Curve[], others: string) =>
    curves.flatMap((curve) =>
      curve.values.map((value, i) => [curve.path, others, value, curve.costs[i] ?? null, curve.status[i] ?? '']),
    )
  return {
    name: 'sensitivity',
    columns: ['parameter', 'others at', 'value', `${run.quantity || 'value'}${ofUnit(run.unit)}`, 'status'],
    rows: [...rows(result.curves, 'nominal'), ...rows(slices?.curves ?? [], called)],
  }
}

interface SmallProps {
  data: RunData
  curve: Curve
  slices: Slices | null
  called: string
  parameter: UncertainParameter
  yRange: [number, number]
  criterion: number | null
  hidden: ReadonlySet<string>
  height: number
}

function Small({ data, curve, slices, called, parameter, yRange, criterion, hidden, height }: SmallProps) {
  const { run, finding } = data
  const [y0, y1] = yRange
  const cost = finding?.cost ?? null
  const spec = useMemo((): PlotSpec => {
    const { path, symbol, unit, text, nominal, low, high } = parameter
    const through = slices?.curves.find((each) => each.path === path)
    const nominals = { x: curve.values, y: curve.costs }
    const others = through && { x: through.values, y: through.costs }
    const xs = others ? union([nominals, others]) : curve.values
    const decimals = decimalsFor([...curve.costs, ...(others?.y ?? [])], 5)
    const digits = decimalsFor([low, high, nominal])
    const at = through && slices?.at[path]
    return {
      label: `${symbolText(run.quantity || 'value')} over ${text}`,
      x: xs,
      lines: [
        { key: 'nominal', label: 'Others at nominal', colour: '--c-nom', y: linesOn(xs, nominals), width: 1.8 },
        ...(others
          ? [{ key: 'worst', label: `Others at ${called}`, colour: '--c-worst', y: linesOn(xs, others), width: 1.8 }]
          : []),
      ],
      points: [
        ...(run.nominal_cost === null ? [] : [{ x: nominal, y: run.nominal_cost, colour: '--c-nom', line: 'nominal' }]),
        ...(at === undefined || cost === null ? [] : [{ x: at, y: cost, colour: '--c-worst', line: 'worst' }]),
      ],
      xTitle: (
        <>
          <Sign text={symbol} path={path} />
          {ofUnit(unitText(unit))}
        </>
      ),
      yTitle: (
        <>
          <Sign text={symbol} path={path} /> <span className="mut">{text}</span>
        </>
      ),
      xTicks: [low, nominal, high],
      xRange: [low, high],
      yRange: [y0, y1],
      yTicks: 4,
      left: 52,
      criterion: criterion === null ? undefined : { value: criterion, tint: true },
      height,
      xText: (x) => `${symbolText(symbol)} = ${fixed(x, digits)} ${unitText(unit)}`,
      yText: (y) => `${fixed(y, decimals)} ${run.unit}`,
    }
  }, [curve, parameter, slices, called, cost, run.quantity, run.unit, run.nominal_cost, y0, y1, criterion, height])
  return <Plot spec={spec} hidden={hidden} />
}
