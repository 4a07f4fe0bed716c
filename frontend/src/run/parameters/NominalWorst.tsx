// Nominal against worst: every uncertain parameter with its position within the bounds, and the results.
import { clsx } from 'clsx'
import { decimalsBeside, decimalsFor, digitsBetween, exact, fixed, NARROW, NONE, plain } from '../../format/numbers'
import { unitText } from '../../format/units'
import { WithinBounds } from '../../ui/bars'
import { Card } from '../../ui/Card'
import { CopyButton } from '../../ui/files'
import { MethodName } from '../../ui/MethodMark'
import { Sign } from '../../ui/Sign'
import { type Best, type RunData, type UncertainParameter, valuesOf } from '../data/data'
import { insteadOf } from '../data/missing'
import { noiseOf } from '../flight/flown'
import { layout, tables } from '../../ui/styles'
import styles from './parameters.module.css'

type Worst = Best & { atBounds?: Record<string, string> }

interface NominalWorstProps {
  data: RunData
  className?: string
  title: string
  note?: string
  /** Header of the column of the other flight; null if only the nominal one is shown. */
  column: string | null
  worst: Worst | null
}

export function NominalWorst({ data, className, title, note, column, worst }: NominalWorstProps) {
  const { run, parameters, nominalTrace, findingTrace } = data
  const decimals = decimalsBeside([run.nominal_cost, worst?.cost], run.threshold)
  const near = [nominalTrace, column === null ? undefined : findingTrace].map((trace) => trace?.meta.closest)
  const both = column !== null
  return (
    <Card
      title={title}
      note={note}
      className={className}
      flush
      right={worst?.method ? <MethodName method={worst.method} short /> : undefined}
      footer={
        worst && (
          <span className={layout.row} style={{ justifyContent: 'space-between' }}>
            Shown rounded; stored at full precision.
            <CopyButton text={() => JSON.stringify(worst.parameters, null, 2)}>Copy values</CopyButton>
          </span>
        )
      }
    >
      <table className={clsx(tables.table, tables.tight)}>
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
          <Lacking data={data} />
          <Told name="Speed at closest approach" unit="m/s" both={both} values={near.map((at) => at?.speed ?? null)} />
          <Told name="Time of closest approach" unit="s" both={both} values={near.map((at) => at?.time ?? null)} />
          <Noise both={both} noises={[noiseOf(nominalTrace), noiseOf(both ? findingTrace : undefined)]} />
          {run.criteria.slice(1).map((criterion) => (
            <Told
              key={criterion.name}
              name={criterion.title}
              sign={criterion.quantity}
              unit={criterion.unit}
              both={both}
              note={criterion.worse === 'high' ? 'more is worse' : 'less is worse'}
              values={[valuesOf(nominalTrace)[criterion.name] ?? null, worst?.values[criterion.name] ?? null]}
            />
          ))}
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
            <td className="small mut">
              {run.threshold !== null && `criterion ${exact(run.threshold)}${NARROW}${run.unit}`}
            </td>
          </tr>
        </tbody>
      </table>
    </Card>
  )
}

/** A parameter whose bounds are relative to its nominal value is listed once its component is known. */
function Lacking({ data }: { data: RunData }) {
  const lacking = Object.keys(data.campaign.uncertain).length - data.parameters.length
  if (lacking <= 0) return null
  return (
    <tr>
      <td colSpan={4} className="sec">
        {data.catalogue ? `${plain(lacking)} more, not described in this installation` : insteadOf(data.missing, 'components')}
      </td>
    </tr>
  )
}

/** Noise realisations of both; empty for a scenario without noise. */
function Noise({ both, noises }: { both: boolean; noises: readonly string[] }) {
  const [nominal, other] = noises.map((noise) => noise.replace('noise seed ', ''))
  if (!nominal && !other) return null
  return (
    <tr>
      <td className="sec">Noise seed</td>
      <td className="num sec">{nominal || NONE}</td>
      {both && <td className="num">{other || NONE}</td>}
      <td />
    </tr>
  )
}

interface ToldProps {
  name: string
  sign?: string
  unit: string
  both: boolean
  note?: string
  /** Values in the nominal flight and in the other one. */
  values: (number | null)[]
}

/** Further results of the two flights; empty if neither has any. */
function Told({ name, sign, unit, both, note, values }: ToldProps) {
  const [nominal, other] = values
  if (nominal === null && (other === null || !both)) return null
  const decimals = sign ? decimalsFor(values) : 2
  return (
    <tr>
      <td className="sec">
        {sign ? (
          <span className={clsx(tables.rn, styles.named)}>
            <span className="m">
              <Sign text={sign} /> <span className="mut small">{unitText(unit)}</span>
            </span>
            <small>{name}</small>
          </span>
        ) : (
          <>
            {name} <span className="mut small">{unit}</span>
          </>
        )}
      </td>
      <td className="num sec">{fixed(nominal, decimals)}</td>
      {both && <td className="num">{fixed(other, decimals)}</td>}
      <td className="small mut">{note}</td>
    </tr>
  )
}

function Row({ parameter, worst, alone }: { parameter: UncertainParameter; worst: Worst | null; alone: boolean }) {
  const { path, symbol, unit, text, nominal, low, high } = parameter
  const value = worst?.parameters[path] ?? null
  const span = decimalsFor([low, high, nominal])
  const digits = digitsBetween(low, high)
  const at = worst?.atBounds?.[path] ?? (value === null ? undefined : edge(value, low, high))
  return (
    <tr>
      <td style={{ paddingRight: 4 }}>
        <span className={clsx(tables.rn, styles.named)} title={path}>
          <span className="m">
            <Sign text={symbol} path={path} /> <span className="mut small">{unitText(unit)}</span>
          </span>
          <small className={styles.two} title={text}>
            {text}
          </small>
          <small className={styles.path}>{path}</small>
        </span>
      </td>
      <td className="num sec">{fixed(nominal, span)}</td>
      {!alone && (
        <td className="num b">
          <span className={clsx(tables.rn, styles.narrow)}>
            {value === null ? NONE : fixed(value, span)}
            {at && <span className={clsx('bad-t', styles.atbound)}>at {at} bound</span>}
          </span>
        </td>
      )}
      <td style={{ width: 104 }}>
        <span className={clsx(tables.rn, styles.narrow)}>
          <WithinBounds low={low} high={high} nominal={nominal} value={value} width={88} />
          <span className={clsx('mut', styles.bounds)}>
            <span>{plain(low, digits)}</span>
            <span>{plain(high, digits)}</span>
          </span>
        </span>
      </td>
    </tr>
  )
}

/** The bound at which a value is, within a hundred-thousandth of the range. */
function edge(value: number, low: number, high: number): string | undefined {
  const reach = 1e-5 * (high - low)
  if (value <= low + reach) return 'low'
  return value >= high - reach ? 'high' : undefined
}
