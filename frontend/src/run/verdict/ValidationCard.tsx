// Validation: nominal case and findings by step halving and the reference integrator, and the repeated evaluations.
import { IconCircleCheck, IconCircleX } from '@tabler/icons-react'
import { clsx } from 'clsx'
import type { SpotChecks, ValidateResult, Validation, Violations } from '../../client'
import { resultOf } from '../../api/stages'
import { count, decimalsFor, fixed, NONE, percent, plain, signed } from '../../format/numbers'
import { sentence, words } from '../../format/spans'
import { Card, NumHead } from '../../ui/Card'
import { methodLook } from '../../ui/methods'
import { Spans } from '../../ui/Spans'
import { Sign } from '../../ui/Sign'
import type { RunData } from '../data/data'
import { casesOf, validatedWord } from '../data/validated'
import badges from '../../ui/badges.module.css'
import lists from '../../ui/lists.module.css'
import tables from '../../ui/tables.module.css'
import styles from './verdict.module.css'

interface ValidationCardProps {
  data: Pick<RunData, 'run' | 'stages' | 'findings' | 'parameters'>
  result: ValidateResult
  className: string | undefined
}

export function ValidationCard({ data, result, className }: ValidationCardProps) {
  const { run } = data
  const cases = casesOf(result, data.findings)
  const neighbours = cases.find((c) => c.neighbours)?.neighbours
  const decimals = decimalsFor(
    cases.map((c) => c.cost),
    7,
  )
  const repeated = cases.some((c) => c.again || c.repeats)
  const first = data.stages.find((s) => s.position === 0)
  const measured = first && resultOf(first, 'nominal')?.measured
  return (
    <Card
      title="Validation"
      note={repeated ? 'The same cases evaluated again' : 'The same cases by other means'}
      className={className}
      id="validation"
      flush={cases.length > 0}
      right={
        <span className={badges.vd} data-tone={result.ok ? 'ok' : 'unk'}>
          {result.ok ? <IconCircleCheck className="i" aria-hidden /> : <IconCircleX className="i" aria-hidden />}
          {result.ok ? 'Passed' : 'Not passed'}
        </span>
      }
      footer={
        <>
          <Spans spans={sentence(result.statement)} />{' '}
          {measured && (
            <span data-testid="measured">
              Measured before the search: the simulator <Spans spans={[...measured.statement, words('. ')]} />
            </span>
          )}
          {[result.violations, result.spot_checks].map(
            (told, i) => told && <Spans key={i} spans={[...sentence(told.statement), words(' ')]} />,
          )}
          Tolerance {percent(result.tolerance)} of the value, and a tenth of the margin.{' '}
          {neighbours && (
            <>
              {count(neighbours.flown)} neighbours of the worst case were simulated
              {neighbours.failed > 0 && `, ${count(neighbours.failed)} of them failed`}:{' '}
              {neighbours.lower_by
                ? `the lowest is ${plain(neighbours.lower_by, 3)} ${run.unit} lower and became the worst case.`
                : 'none is lower.'}
            </>
          )}
        </>
      }
    >
      {cases.length > 0 ? (
        <table className={clsx(tables.table, tables.tight)}>
          <thead>
            <tr>
              <th>Case</th>
              <th>{repeated ? 'Evaluation' : 'Integration'}</th>
              <NumHead unit="ms">Step</NumHead>
              <NumHead unit={run.unit}><Sign text={run.quantity || 'value'} /></NumHead>
              <NumHead unit={run.unit}>Change</NumHead>
              <NumHead unit={run.unit}>Allowed</NumHead>
            </tr>
          </thead>
          <tbody>
            {cases.map((c) => (
              <Rows key={c.name} item={c} decimals={decimals} />
            ))}
          </tbody>
        </table>
      ) : (
        <p className="sec">The cases are not stored.</p>
      )}
      {result.violations && result.spot_checks && (
        <Again data={data} repeated={repeated} violations={result.violations} spots={result.spot_checks} />
      )}
    </Card>
  )
}

interface AgainProps {
  data: Pick<RunData, 'run' | 'stages'>
  /** Evaluated again by the same simulator only. */
  repeated: boolean
  violations: Violations
  spots: SpotChecks
}

/** Numbers of repeated evaluations besides nominal case and findings. */
function Again({ data: { run, stages }, repeated, violations, spots }: AgainProps) {
  const unit = run.unit
  const apart = (value: number | null) => (value === null ? NONE : `${plain(value, 3)} ${unit}`)
  const { at } = spots
  const stage = at && stages.find((s) => s.position === at.position)
  return (
    <dl className={clsx(lists.kv, styles.again)} aria-label={repeated ? 'Evaluated again' : 'Simulated again'}>
      <dt>Stored violations</dt>
      <dd data-testid="violations">
        {count(violations.stored)} stored, {count(violations.checked)} checked, {count(violations.confirmed)} confirmed
      </dd>
      <dt>Random evaluations, {repeated ? 'evaluated again' : 'reference integrator'}</dt>
      <dd data-testid="spot-checks">
        {count(spots.compared)} of {count(spots.checked)} compared
        {spots.violating > 0 && <span className="bad-t">, {count(spots.violating)} violate there only</span>}
      </dd>
      <dt>Difference from the stored value</dt>
      <dd title={at ? Object.entries(at.parameters).map(([path, v]) => `${path} = ${plain(v, 9)}`).join('\n') : undefined}>
        median {apart(spots.median)}, largest {apart(spots.largest)}
        {at && `, ${stage?.method ? methodLook(stage.method).title : (stage?.kind ?? 'stage')} evaluation ${count(at.index + 1)}`}
        {at && at.realisation !== null && `, noise seed ${at.realisation}`}
      </dd>
    </dl>
  )
}

function Rows({ item, decimals }: { item: Validation; decimals: number }) {
  const name = item.name === 'nominal' ? 'Nominal' : item.name === 'F1' ? 'Worst, F1' : item.name
  const { half_step: half, integrator, again, repeats } = item
  const lowest = repeats ? Math.min(...repeats.values.filter((v) => v !== null)) : NaN
  const rows = [
    { key: 'run', text: again || repeats ? 'As searched' : 'Run step, RK4', step: item.step, cost: item.cost, change: undefined },
    ...(half
      ? [{ key: 'half', text: again ? 'Half step' : 'Half step, RK4', step: half.step, cost: half.cost, change: half.difference }]
      : []),
    ...(integrator
      ? [{ key: 'other', text: integrator.name, step: null, cost: integrator.cost, change: integrator.difference }]
      : []),
    ...(again
      ? [{ key: 'again', text: again.name.charAt(0).toUpperCase() + again.name.slice(1), step: null, cost: again.cost, change: again.difference }]
      : []),
    ...(repeats
      ? [{ key: 'repeats', text: `Lowest of ${count(repeats.values.length)} independent calls`, step: null, cost: Number.isFinite(lowest) ? lowest : null, change: undefined }]
      : []),
  ]
  return rows.map((row, i) => {
    const over = typeof row.change === 'number' && item.allowed !== null && Math.abs(row.change) > item.allowed
    return (
      <tr key={row.key}>
        <td className="m">
          {i === 0 && name}
          {i === 1 && <span className={item.ok ? 'small sec' : 'small unk-t'}>{validatedWord(item)}</span>}
          {i === 2 && item.realisation !== null && (
            <span className="small mut">noise seed {item.realisation}</span>
          )}
        </td>
        <td className="sec">{row.text}</td>
        <td className="num sec">{row.step === null ? (again || repeats ? NONE : 'adaptive') : plain(row.step * 1000)}</td>
        <td className="num">{fixed(row.cost, decimals)}</td>
        <td className={over ? 'num b bad-t' : 'num sec'}>
          {row.change === undefined ? NONE : row.change === null ? 'no value' : signedSmall(row.change)}
          {over && ' too large'}
        </td>
        <td className="num mut">{row.change === undefined ? '' : plain(item.allowed, 2)}</td>
      </tr>
    )
  })
}

/** A signed difference with two significant digits. */
function signedSmall(value: number): string {
  if (value === 0) return '0'
  return Math.abs(value) < 1e-4 ? `${value > 0 ? '+' : ''}${plain(value, 2)}` : signed(value, decimalsFor([value], 2))
}
