// Sensitivity: each parameter over its bounds with the others nominal; the curves share the vertical axis.
import { useMemo, useState } from 'react'
import type { SensitivityCurve, SensitivityResult } from '../api/results'
import { ChartCard } from '../charts/ChartCard'
import { Plot } from '../charts/Plot'
import type { PlotSpec } from '../charts/spec'
import { padded } from '../charts/ticks'
import { decimalsFor, fixed, plain } from '../format/numbers'
import { unitText } from '../format/units'
import { Seg } from '../ui/Card'
import { Sign, symbolText } from '../ui/Sign'
import type { RunData, UncertainParameter } from './data'

interface SensitivityCardProps {
  data: RunData
  result: SensitivityResult
  className: string
  /** Of each plot [px]. */
  height: number
}

export function SensitivityCard({ data, result, className, height }: SensitivityCardProps) {
  const { run, parameters } = data
  const [axis, setAxis] = useState<'near' | 'all'>('near')
  const costs = result.curves.flatMap((curve) => curve.costs.filter((cost): cost is number => cost !== null))
  const threshold = run.threshold
  const far = threshold !== null && costs.length > 0 && Math.min(...costs) - threshold > 6 * spread(costs)
  const withCriterion = threshold !== null && (!far || axis === 'all')
  const yRange = padded(withCriterion ? [...costs, threshold] : costs, false, 0.1)
  const failed = result.curves.reduce((sum, curve) => sum + curve.status.filter((s) => s !== 'ok').length, 0)
  const table = () => ({
    name: 'sensitivity',
    columns: ['parameter', 'value', `${run.quantity}, ${run.unit}`, 'status'],
    rows: result.curves.flatMap((curve) =>
      curve.values.map((value, i) => [curve.path, value, curve.costs[i] ?? null, curve.status[i] ?? '']),
    ),
  })
  return (
    <ChartCard
      title={
        <>
          Sensitivity of <Sign text={run.quantity || 'value'} />
        </>
      }
      note={`${run.unit}, ${result.points} points per curve, others nominal`}
      className={className}
      id="sensitivity"
      run={run.id}
      data={table}
      right={
        far && (
          <Seg
            label="Vertical axis"
            options={[
              { value: 'near', label: 'Values' },
              { value: 'all', label: 'With criterion' },
            ]}
            value={axis}
            onChange={setAxis}
          />
        )
      }
      footer={failed > 0 ? `${failed} of these flights gave no value; the curves have gaps there.` : undefined}
    >
      <div className="smalls">
        {result.curves.map((curve) => {
          const parameter = parameters.find((p) => p.path === curve.path)
          return parameter ? (
            <Small
              key={curve.path}
              data={data}
              curve={curve}
              parameter={parameter}
              yRange={yRange}
              criterion={withCriterion}
              height={height}
            />
          ) : null
        })}
      </div>
      {far && axis === 'near' && (
        <p className="fig">
          The criterion, {plain(threshold)} {run.unit}, lies off these axes.
        </p>
      )}
    </ChartCard>
  )
}

const spread = (values: number[]): number => Math.max(...values) - Math.min(...values)

interface SmallProps {
  data: RunData
  curve: SensitivityCurve
  parameter: UncertainParameter
  yRange: [number, number]
  criterion: boolean
  height: number
}

function Small({ data, curve, parameter, yRange, criterion, height }: SmallProps) {
  const { run } = data
  const { symbol, unit, text, nominal, low, high } = parameter
  const [y0, y1] = yRange
  const spec = useMemo((): PlotSpec => {
    const decimals = decimalsFor(curve.costs, 5)
    const digits = decimalsFor([low, high, nominal])
    return {
      label: `${symbolText(run.quantity)} over ${text}`,
      x: curve.values,
      lines: [{ key: 'nominal', label: 'Others nominal', colour: '--c-nom', y: curve.costs, width: 1.8 }],
      points: run.nominal_cost === null ? [] : [{ x: nominal, y: run.nominal_cost, colour: '--c-nom' }],
      xTitle: (
        <>
          <Sign text={symbol} />
          {unit && `, ${unitText(unit)}`}
        </>
      ),
      yTitle: (
        <>
          <Sign text={symbol} /> <span className="mut">{text}</span>
        </>
      ),
      xTicks: [low, nominal, high],
      xRange: [low, high],
      yRange: [y0, y1],
      yTicks: 4,
      left: 52,
      criterion: criterion && run.threshold !== null ? { value: run.threshold, tint: true } : undefined,
      height,
      xText: (x) => `${symbolText(symbol)} = ${fixed(x, digits)} ${unitText(unit)}`,
      yText: (y) => `${fixed(y, decimals)} ${run.unit}`,
    }
  }, [
    curve,
    run.quantity,
    run.unit,
    run.threshold,
    run.nominal_cost,
    symbol,
    unit,
    text,
    nominal,
    low,
    high,
    y0,
    y1,
    criterion,
    height,
  ])
  return <Plot spec={spec} />
}
