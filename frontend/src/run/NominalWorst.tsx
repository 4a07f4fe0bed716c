// Nominal against worst: every uncertain parameter, where it lies within its bounds, and what comes of it.
import { decimalsFor, fixed, NONE, plain } from '../format/numbers'
import { unitText } from '../format/units'
import { WithinBounds } from '../ui/bars'
import { Card } from '../ui/Card'
import { CopyButton } from '../ui/files'
import { MethodName } from '../ui/MethodMark'
import { Sign } from '../ui/Sign'
import type { RunData, UncertainParameter } from './data'

interface Worst {
  cost: number
  parameters: Record<string, number>
  method: string | null
  atBounds?: Record<string, string>
}

interface NominalWorstProps {
  data: RunData
  className: string
  title: string
  /** Head of the column of the other flight; null for the nominal one alone. */
  column: string | null
  worst: Worst | null
  id?: string
}

export function NominalWorst({ data, className, title, column, worst, id }: NominalWorstProps) {
  const { run, parameters, nominalTrace, findingTrace } = data
  const decimals = decimalsFor([run.nominal_cost, worst?.cost])
  const times = [closest(nominalTrace), closest(findingTrace)]
  return (
    <Card
      title={title}
      className={className}
      id={id}
      flush
      right={worst?.method ? <MethodName method={worst.method} short /> : undefined}
      footer={
        worst && (
          <span className="row" style={{ justifyContent: 'space-between' }}>
            Shown rounded; stored at full precision.
            <CopyButton text={() => JSON.stringify(worst.parameters, null, 2)}>Copy values</CopyButton>
          </span>
        )
      }
    >
      <table className="tight">
        <thead>
          <tr>
            <th>Parameter</th>
            <th className="num">Nominal</th>
            {column !== null && <th className="num">{column}</th>}
            <th>Within bounds</th>
          </tr>
        </thead>
        <tbody>
          {parameters.map((parameter) => (
            <Row key={parameter.path} parameter={parameter} worst={worst} alone={column === null} />
          ))}
          {times.some((time) => time !== null) && (
            <tr>
              <td className="sec">
                Time of closest approach <span className="mut small">s</span>
              </td>
              <td className="num sec">{fixed(times[0], 2)}</td>
              {column !== null && <td className="num">{fixed(times[1], 2)}</td>}
              <td />
            </tr>
          )}
          <tr>
            <td className="m">
              <Sign text={run.quantity || 'value'} /> <span className="mut small">{run.unit}</span>
            </td>
            <td className="num sec">{fixed(run.nominal_cost, decimals)}</td>
            {column !== null && (
              <td className="num b" data-testid="worst-cost">
                {fixed(worst?.cost, decimals)}
              </td>
            )}
            <td className="small mut">criterion {plain(run.threshold)}</td>
          </tr>
        </tbody>
      </table>
    </Card>
  )
}

function closest(trace: RunData['nominalTrace']): number | null {
  const time = (trace?.meta.closest as { time?: unknown } | undefined)?.time
  return typeof time === 'number' ? time : null
}

function Row({ parameter, worst, alone }: { parameter: UncertainParameter; worst: Worst | null; alone: boolean }) {
  const { path, symbol, unit, text, nominal, low, high } = parameter
  const value = worst?.parameters[path] ?? null
  const span = decimalsFor([low, high, nominal])
  const at = worst?.atBounds?.[path] ?? (value === null ? undefined : edge(value, low, high))
  return (
    <tr>
      <td style={{ paddingRight: 4 }}>
        <span className="rn" title={path}>
          <span className="m">
            <Sign text={symbol} /> <span className="mut small">{unitText(unit)}</span>
          </span>
          <small>{text}</small>
        </span>
      </td>
      <td className="num sec">{fixed(nominal, span)}</td>
      {!alone && (
        <td className="num b">
          <span className="rn">
            {value === null ? NONE : fixed(value, span)}
            {at && <span className="atbound">at {at} bound</span>}
          </span>
        </td>
      )}
      <td style={{ width: 118 }}>
        <span className="rn">
          <WithinBounds low={low} high={high} nominal={nominal} value={value} />
          <span className="bounds">
            <span>{plain(low)}</span>
            <span>{plain(high)}</span>
          </span>
        </span>
      </td>
    </tr>
  )
}

/** Which bound a value lies on, within a hundred-thousandth of the range. */
function edge(value: number, low: number, high: number): string | undefined {
  const reach = 1e-5 * (high - low)
  if (value <= low + reach) return 'low'
  return value >= high - reach ? 'high' : undefined
}
