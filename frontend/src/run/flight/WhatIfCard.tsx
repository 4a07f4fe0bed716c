// The what-if next to the 3D view: a slider and a field for every uncertain parameter, and the result.
import { IconAlertTriangle, IconX } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { type CSSProperties, type KeyboardEvent, useState } from 'react'
import { flushSync } from 'react-dom'
import { hasScenario } from '../../api/campaign'
import type { FlightAnswer, FlightValue } from '../../client'
import { decimalsBeside, decimalsFor, digitsBetween, exact, field, fixed, margin, NARROW, NONE, parse, plain } from '../../format/numbers'
import { unitText } from '../../format/units'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { IconButton } from '../../ui/IconButton'
import { Sign } from '../../ui/Sign'
import { NOMINAL, worstOf } from '../data/chosen'
import { InstalledNote } from './CaseNote'
import type { RunData, UncertainParameter } from '../data/data'
import type { WhatIfState } from './useWhatIf'
import { baseOf, otherCodeOf, STEPS, stepped, valuesOf, type WhatIf, within, withValue } from './whatif'
import { Select } from '../../ui/Select'
import { fields, layout } from '../../ui/styles'
import runStyles from '../run.module.css'
import styles from './flight.module.css'

interface Props {
  data: RunData
  state: WhatIfState
  className?: string
}

export function WhatIfCard({ data, state, className }: Props) {
  const { whatIf, change, toggle } = state
  if (!whatIf) return null
  const values = valuesOf(whatIf, data)
  const changed = Object.keys(whatIf.set).length
  const name = nameOf(data, whatIf.like)
  return (
    <Card
      title="What-if"
      note={changed ? `${changed} changed` : `as ${name}`}
      className={clsx(runStyles.whatIf, className)}
      id="what-if"
      flush
      right={<IconButton label="Close the what-if" icon={IconX} act={toggle} />}
      footer={
        <span className={clsx(layout.row, styles.whatIfFrom)}>
          <label className={layout.row}>
            Begin at
            <Select
              label="Begin at the parameters of"
              value={whatIf.like}
              options={[NOMINAL, ...data.findings.map(({ label }) => label)].map((label) => ({ value: label, label: nameOf(data, label) }))}
              onChange={(like) => change({ like, set: {}, seed: null })}
            />
          </label>
          <Button small className={layout.atend} disabled={changed === 0 && whatIf.seed === null} onClick={() => change({ like: whatIf.like, set: {}, seed: null })}>
            Back to {name}
          </Button>
        </span>
      }
    >
      <Outcome data={data} state={state} />
      <div className={styles.whatIfRows}>
        {data.parameters.map((parameter) => (
          <Row
            key={parameter.path}
            parameter={parameter}
            value={values[parameter.path] ?? parameter.nominal}
            base={baseOf(whatIf.like, data)[parameter.path] ?? parameter.nominal}
            worst={data.finding?.parameters[parameter.path] ?? null}
            changed={parameter.path in whatIf.set}
            onChange={(value) => change(withValue(whatIf, parameter, value, data))}
          />
        ))}
        {data.parameters.length === 0 && (
          <p className="small sec">{hasScenario(data.campaign) ? 'The components of this campaign are' : 'The simulator of this campaign is'} not described in this installation.</p>
        )}
      </div>
    </Card>
  )
}

const nameOf = ({ run }: RunData, like: string): string => (like === NOMINAL ? 'nominal' : like === worstOf(run) ? `worst (${like})` : like)

/** The result: value and margin with units, or why there are none. */
function Outcome({ data, state }: Omit<Props, 'className'>) {
  const { answer, refused, busy, whatIf } = state
  const { run } = data
  const flies = hasScenario(data.campaign)
  return (
    <div className={styles.whatIfOut} role="status" aria-busy={busy} aria-label={flies ? 'What-if flight' : 'What-if case'}>
      <div className={styles.whatIfFigures}>
        <Figure
          name={<Sign text={run.quantity || 'value'} />}
          value={answer?.cost ?? null}
          text={fixed(answer?.cost, decimalsBeside([answer?.cost, run.nominal_cost], run.threshold))}
          unit={run.unit}
          testId="what-if-cost"
        />
        <Figure
          name="Margin"
          value={answer?.margin ?? null}
          text={margin(answer?.margin, decimalsBeside([answer?.cost, run.nominal_cost], run.threshold))}
          unit={run.unit}
          bad={typeof answer?.margin === 'number' && answer.margin <= 0}
          testId="what-if-margin"
        />
      </div>
      {refused !== null ? (
        <p className={styles.whatIfWhy} role="alert">
          <IconAlertTriangle className="i s" aria-hidden /> {refused}
        </p>
      ) : answer && answer.status !== 'ok' ? (
        <p className={styles.whatIfWhy}>
          <IconAlertTriangle className="i s" aria-hidden /> {stateOf(answer)}
        </p>
      ) : (
        <p className="small sec">{flies || answer ? wordsOf(answer, whatIf) : busy ? 'Evaluating …' : 'Not evaluated yet.'}</p>
      )}
      {answer && otherCodeOf(answer) && (
        <p className={styles.whatIfWhy} data-testid="what-if-code">
          <IconAlertTriangle className="i s" aria-hidden /> {otherCodeOf(answer)}
        </p>
      )}
      {!flies && <InstalledNote run={run.id} {...state} />}
      {answer && answer.criteria.length > 1 && (
        <dl className={styles.whatIfMore}>
          {answer.criteria.slice(1).map((one) => (
            <Further key={one.name} one={one} />
          ))}
        </dl>
      )}
    </div>
  )
}

interface FigureProps {
  name: React.ReactNode
  value: number | null
  text: string
  unit: string
  bad?: boolean
  testId: string
}

function Figure({ name, value, text, unit, bad, testId }: FigureProps) {
  return (
    <div className={styles.whatIfFigure}>
      <span className={clsx('sec', styles.k)}>{name}</span>
      <span className={bad ? clsx(styles.n, 'b num bad-t') : clsx(styles.n, 'b num')}>
        <span data-testid={testId}>{text}</span>
        {value !== null && <small>{unit}</small>}
      </span>
    </div>
  )
}

function Further({ one: { title, value, unit, worse } }: { one: FlightValue }) {
  return (
    <div>
      <dt className="sec" title={worse === 'high' ? 'more is worse' : 'less is worse'}>{title}</dt>
      <dd className="num">
        {fixed(value, decimalsFor([value]))} {value !== null && <span className="mut">{unitText(unit)}</span>}
      </dd>
    </div>
  )
}

const stateOf = ({ status, reason }: FlightAnswer): string => {
  const word = { failed: 'Failed', excluded: 'Excluded', timeout: 'Timed out', ok: '' }[status]
  return reason ? `${word}: ${reason}` : word
}

/** Criterion, time of the closest approach, and noise realisation if any. */
function wordsOf(answer: FlightAnswer | null, whatIf: WhatIf | null): string {
  if (!answer) return 'Simulating …'
  const { trace, threshold, unit } = answer
  const near = trace.closest ? [`closest at ${fixed(trace.closest.time, 2)}${NARROW}s`] : []
  const seeds = trace.realisation
  const noise = !seeds ? [] : [`noise seed ${seeds.seed}${seeds.seeds > 1 ? `, the lowest of ${seeds.seeds}` : ''}`]
  const own = seeds && whatIf?.seed != null ? ['of the evaluation chosen in the parameter space'] : []
  return [`criterion ${exact(threshold)}${NARROW}${unit}`, ...near, [...noise, ...own].join(' ')].filter(Boolean).join(', ')
}

interface RowProps {
  parameter: UncertainParameter
  value: number
  base: number
  /** Value in the displayed finding. */
  worst: number | null
  changed: boolean
  onChange: (value: number) => void
}

function Row({ parameter, value, base, worst, changed, onChange }: RowProps) {
  const { path, symbol, unit, text, low, high, nominal } = parameter
  const label = `${text || path}${unit ? `, ${unitText(unit)}` : ''}`
  const at = (of: number) => (high > low ? (of - low) / (high - low) : 0)
  return (
    <div className={styles.whatIfRow}>
      <span className={clsx(layout.cut, changed && 'b')} title={`${path}: ${text}`}>
        <Sign text={symbol} path={path} /> <span className="mut small">{unitText(unit)}</span>
      </span>
      <span className={clsx(layout.row, fields.scrub)}>
        <input
          type="range"
          aria-label={label}
          aria-valuetext={`${fixed(value, decimalsFor([low, high, nominal]))} ${unit}`.trim()}
          min={0}
          max={STEPS}
          step="any"
          value={STEPS * at(value)}
          style={{ '--done': `${100 * at(value)}%` } as CSSProperties}
          onKeyDown={(event) => moved(event, parameter, value, onChange)}
          onDoubleClick={() => onChange(base)}
          onChange={(event) => {
            const share = Number(event.target.value) / STEPS
            onChange(share >= 1 ? high : low + share * (high - low))
          }}
        />
        <i title={`Nominal ${plain(nominal)}`} style={{ '--at': at(nominal), background: 'var(--c-nom)' } as CSSProperties} />
        {worst !== null && <i title="The finding shown" style={{ '--at': at(worst), background: 'var(--c-worst)' } as CSSProperties} />}
      </span>
      <Field parameter={parameter} label={`${label}, value`} value={value} onChange={onChange} />
    </div>
  )
}

const KEYS: Readonly<Record<string, number>> = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -20, PageUp: 20 }

/** Arrow keys step through the range; at the ends the value is exactly the bound. */
function moved(event: KeyboardEvent, parameter: UncertainParameter, value: number, onChange: (value: number) => void): void {
  const { low, high } = parameter
  const steps = KEYS[event.key]
  if (steps === undefined && event.key !== 'Home' && event.key !== 'End') return
  event.preventDefault()
  event.stopPropagation() // elsewhere in the card arrow keys change the time
  onChange(steps === undefined ? (event.key === 'Home' ? low : high) : stepped(parameter, value, steps))
}

interface FieldProps {
  parameter: UncertainParameter
  label: string
  value: number
  onChange: (value: number) => void
}

/** The value as text: rounded for reading, at full precision for editing. */
function Field({ parameter, label, value, onChange }: FieldProps) {
  const { low, high, nominal } = parameter
  const [typed, setTyped] = useState<string | null>(null)
  const meant = typed === null ? value : parse(typed)
  const wrong = meant === null || !within(parameter, meant)
  const digits = digitsBetween(low, high)
  const range = `${plain(low, digits)} to ${plain(high, digits)} ${unitText(parameter.unit)}`.trim()
  const take = () => {
    if (typed !== null && meant !== null && !wrong && meant !== value) onChange(meant)
    setTyped(null)
  }
  return (
    <input
      className={clsx(fields.cell, 'num')}
      inputMode="decimal"
      autoComplete="off"
      spellCheck={false}
      aria-label={label}
      aria-invalid={wrong}
      title={wrong ? `Give a number from ${range}` : range}
      value={typed ?? (Number.isFinite(value) ? fixed(value, decimalsFor([low, high, nominal])) : NONE)}
      onFocus={({ currentTarget }) => {
        // Set immediately and selected: typing should replace the text, not extend it.
        flushSync(() => setTyped(field(value)))
        currentTarget.select()
      }}
      onBlur={take}
      onChange={(event) => {
        setTyped(event.target.value)
        const next = parse(event.target.value)
        if (next !== null && within(parameter, next)) onChange(next)
      }}
      onKeyDown={(event) => {
        if (event.key === 'Enter') take()
        if (event.key === 'Escape') setTyped(null)
      }}
    />
  )
}
