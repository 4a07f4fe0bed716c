// One uncertain parameter: values, distribution, and the service's problems.
import { clsx } from 'clsx'
import { place, type Raw, type Uncertain } from '../../api/campaign'
import { unitText } from '../../format/units'
import { Sign } from '../../ui/Sign'
import { Density } from './Density'
import { Choice } from '../fields/Field'
import { NumberCell } from '../fields/NumberCell'
import { boundsOf, numberOf, type Parameter } from '../campaign/parameters'
import { idOf, Message, useProblems } from '../fields/problems'
import type { SetValue } from '../fields/props'
import { fields, layout } from '../../ui/styles'
import styles from './form.module.css'
import { lastOf } from '../../format/names'

const KINDS = [
  { value: 'uniform', label: 'Uniform' },
  { value: 'normal', label: 'Normal' },
  { value: 'truncated_normal', label: 'Truncated normal' },
  { value: 'triangular', label: 'Triangular' },
  { value: 'beta', label: 'Beta' },
]

const NUMBERS = {
  normal: ['mean', 'deviation'],
  truncated_normal: ['mean', 'deviation'],
  triangular: ['mode'],
  beta: ['alpha', 'beta'],
} as const

interface UncertainRowProps {
  path: string
  /** Distinct among the rows, for the names of its controls. */
  name: string
  parameter: Parameter | undefined
  /** Undefined if held at the nominal value. */
  uncertain: Uncertain | undefined
  fixed: Uncertain | undefined
  onToggle: (on: boolean) => void
  set: SetValue
}

export function UncertainRow({ path, name, parameter, uncertain, fixed, onToggle, set }: UncertainRowProps) {
  const field = `uncertain.${path}`
  const own = useProblems(field, true)
  const nominalProblems = useProblems(parameter?.field ?? field)
  const problems = parameter ? [...own, ...nominalProblems] : own
  const on = uncertain !== undefined
  const shown = uncertain ?? fixed ?? {}
  const nominal = parameter?.nominal ?? null
  const [low, high] = boundsOf(shown, nominal)
  const distribution = shown.distribution ?? { kind: 'uniform' }
  const shaped = on && distribution.kind !== 'uniform'
  // An edited bound replaces a plus-minus; the other bound is unchanged.
  const bounds = { low, high }
  const wide = problems.some((p) => p.field === field || p.field.endsWith('.plus_minus'))
  const numbers = { low: numberOf(low), high: numberOf(high), nominal: numberOf(nominal) }
  const distribute = (kind: string) =>
    set(['uncertain', path], { ...shown, distribution: distributionOf(kind, numbers) })
  return (
    <>
      <tr
        className={clsx(on ? '' : styles.off, problems.length || shaped ? styles.hasError : '')}
        id={idOf(field)}
        tabIndex={-1}
      >
        <td>
          <input
            className={fields.check}
            type="checkbox"
            checked={on}
            aria-label={`${name} varies`}
            onChange={(e) => onToggle(e.target.checked)}
          />
        </td>
        <td>
          <Sign text={parameter?.entry.symbol || lastOf(path)} />
        </td>
        <td title={path} className={styles.meant}>
          {parameter?.entry.text ?? path}
          {parameter && parameter.group !== 'Vehicle' && !path.startsWith('simulator.') && (
            <span className="mut"> · {parameter.group.toLowerCase()}</span>
          )}
        </td>
        <td>
          {parameter && (
            <NumberCell
              field={`${field}.nominal`}
              label={`${name}, nominal`}
              value={nominal}
              invalid={nominalProblems.length > 0}
              onChange={(value) => set(place(path), value ?? '')}
            />
          )}
        </td>
        {(['low', 'high'] as const).map((which) => (
          <td key={which}>
            <NumberCell
              field={`${field}.${which}`}
              label={`${name}, ${which}`}
              value={bounds[which]}
              disabled={!on}
              invalid={wide}
              onChange={(value) => set(['uncertain', path], { ...shown, plus_minus: null, ...bounds, [which]: value })}
            />
          </td>
        ))}
        <td className="sec nw">{unitText(parameter?.entry.unit ?? '')}</td>
        <td>
          <Choice
            aria-label={`${name}, distribution`}
            data={KINDS}
            value={distribution.kind}
            disabled={!on}
            w={146}
            onChange={distribute}
          />
        </td>
        <td className={layout.hideN}>
          <Density {...numbers} distribution={distribution} />
        </td>
      </tr>
      {shaped && (
        <tr className={problems.length ? styles.hasError : undefined}>
          <td colSpan={7} />
          <td colSpan={2}>
            <DistributionFields field={field} path={path} name={name} distribution={distribution} set={set} />
          </td>
        </tr>
      )}
      {problems.length > 0 && (
        <tr className={styles.errors}>
          <td />
          <td colSpan={8}>
            {problems.map((problem) => (
              <Message key={problem.field + problem.message} problem={problem} />
            ))}
          </td>
        </tr>
      )}
    </>
  )
}

interface DistributionFieldsProps {
  field: string
  path: string
  name: string
  distribution: NonNullable<Uncertain['distribution']>
  set: SetValue
}

function DistributionFields({ field, path, name, distribution, set }: DistributionFieldsProps) {
  const keys = NUMBERS[distribution.kind as keyof typeof NUMBERS] ?? []
  return (
    <span className={layout.row}>
      {keys.map((key) => (
        <span key={key} className={clsx(layout.row, 'small mut')} style={{ gap: 5 }}>
          {key}
          <span style={{ width: 84 }}>
            <NumberCell
              field={`${field}.distribution.${key}`}
              label={`${name}, ${key}`}
              value={distribution[key]}
              onChange={(value) => set(['uncertain', path, 'distribution', key], value ?? '')}
            />
          </span>
        </span>
      ))}
    </span>
  )
}

interface Numbers {
  low: number | null
  high: number | null
  nominal: number | null
}

/** Initial parameters of a distribution: centred at the nominal value, bounds at three standard deviations. */
function distributionOf(kind: string, { low, high, nominal }: Numbers): NonNullable<Uncertain['distribution']> {
  if (kind === 'uniform') return { kind }
  const middle: Raw = nominal ?? ''
  if (kind === 'triangular') return { kind, mode: middle }
  if (kind === 'beta') return { kind, alpha: 2, beta: 2 }
  return { kind, mean: middle, deviation: low !== null && high !== null ? (high - low) / 6 : '' }
}
