// Validation: nominal case and findings by step halving and the reference integrator, and the repeated evaluations.
import { IconCircleCheck, IconCircleX } from '@tabler/icons-react'
import { clsx } from 'clsx'
import type { SpotChecks, ValidateResult, Validation, Violations } from '../../client'
import { resultWith } from '../../api/stages'
import { count, decimalsFor, fixed, NONE, percent, plain, signed } from '../../format/numbers'
import { sentence, words } from '../../format/spans'
import { Card } from '../../ui/Card'
import { methodLook } from '../../ui/methods'
import { Spans } from '../../ui/Spans'
import { Sign } from '../../ui/Sign'
import { Table } from '../../ui/Table'
import { worstOf } from '../data/chosen'
import type { RunData } from '../data/data'
import { casesOf, validatedWord } from '../data/validated'
import { lists } from '../../ui/styles'
import styles from './verdict.module.css'
import { Badge } from '../../ui/VerdictBadge'

interface ValidationCardProps {
  data: Pick<RunData, 'run' | 'stages' | 'findings' | 'parameters'>
  result: ValidateResult
}

/** The checks of the verdict on what was evaluated again. */
const CHECKS: ReadonlySet<string> = new Set(['validation', 'repetition'])

export function ValidationCard({ data, result }: ValidationCardProps) {
  const { run } = data
  const cases = casesOf(result, data.findings)
  const neighbours = cases.find((c) => c.neighbours)?.neighbours
  const decimals = decimalsFor(
    cases.map((c) => c.cost),
    7,
  )
  // The check also counts what was repeated besides the cases.
  const failing = data.run.summary?.checks.some(({ name, ok }) => CHECKS.has(name) && !ok)
  const passed = result.ok && !failing
  const repeated = cases.some((c) => c.again || c.repeats)
  const measured = resultWith(data.stages, 'measured')?.measured
  return (
    <Card
      title="Validation"
      note={repeated ? 'The same cases evaluated again' : 'The same cases by other means'}
      id="validation"
      flush={cases.length > 0}
      right={<Badge tone={passed ? 'ok' : 'unk'} Icon={passed ? IconCircleCheck : IconCircleX}>{passed ? 'Passed' : 'Not passed'}</Badge>}
      footer={
        <>
          <Spans spans={sentence(result.statement)} />{' '}
          {measured && (
            <span data-testid="measured">
              Measured before the search: the simulator <Spans spans={[...measured.statement, words('. ')]} />
            </span>
          )}
          {[result.violations, result.spot_checks].map(
            (check, i) => check && <Spans key={i} spans={[...sentence(check.statement), words(' ')]} />,
          )}
          Tolerance {percent(result.tolerance)} of the value, and a tenth of the margin.{' '}
          {neighbours && (
            <>
              {count(neighbours.flown)} neighbours of the worst case were simulated
              {neighbours.failed > 0 && `, ${count(neighbours.failed)} failed`}:{' '}
              {neighbours.lowest === null
                ? 'none of them has a value.'
                : neighbours.lower_by
                ? `the lowest is ${plain(neighbours.lower_by, 3)} ${run.unit} lower and became the worst case.`
                : 'none is lower.'}
            </>
          )}
        </>
      }
    >
      {cases.length > 0 ? (
        <Table
          tight
          rows={cases.flatMap(rowsOf)}
          columns={[
            { head: 'Case', tone: 'm', cell: (row) => <Case row={row} worst={worstOf(run)} /> },
            { head: repeated ? 'Evaluation' : 'Integration', tone: 'sec', cell: ({ text }) => text },
            {
              head: 'Step',
              unit: 'ms',
              tone: 'sec',
              cell: ({ item, step }) => (step === null ? (item.again || item.repeats ? NONE : 'adaptive') : plain(step * 1000)),
            },
            { head: <Sign text={run.quantity || 'value'} />, unit: run.unit, cell: ({ cost }) => fixed(cost, decimals) },
            {
              head: 'Change',
              unit: run.unit,
              tone: (row) => (isOver(row) ? 'b bad-t' : 'sec'),
              cell: (row) => `${row.change === undefined ? NONE : row.change === null ? 'no value' : signedSmall(row.change)}${isOver(row) ? ' too large' : ''}`,
            },
            { head: 'Allowed', unit: run.unit, tone: 'mut', cell: ({ item, change }) => (change === undefined ? '' : plain(item.allowed, 2)) },
          ]}
        />
      ) : (
        <p className="sec">The cases are not stored.</p>
      )}
      {result.violations && result.spot_checks && (
        <Again
          data={data}
          repeated={repeated}
          violations={result.violations}
          spots={result.spot_checks}
          leftOut={result.spent?.left_out.spot_checks ?? 0}
        />
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
  /** Random evaluations for which the allowance of validation did not suffice: they are not among `spots`. */
  leftOut: number
}

/** Numbers of repeated evaluations besides nominal case and findings. */
function Again({ data: { run, stages }, repeated, violations, spots, leftOut }: AgainProps) {
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
        {count(spots.compared)} of {count(spots.checked + leftOut)} compared
        {spots.violating > 0 && <span className="bad-t">, {count(spots.violating)} violate there only</span>}
      </dd>
      <dt>Difference from the stored value</dt>
      <dd title={at ? Object.entries(at.parameters).map(([path, v]) => `${path} = ${plain(v, 9)}`).join('\n') : undefined}>
        median {apart(spots.median)}, largest {apart(spots.largest)}
        {at && `, ${stage?.method ? methodLook(stage.method).title : (stage?.kind ?? 'stage')}, ${at.position}:${at.index} in evaluations.csv`}
        {at && at.realisation !== null && `, noise seed ${at.realisation}`}
      </dd>
    </dl>
  )
}

interface Row {
  item: Validation
  /** Of the rows of its case. */
  number: number
  text: string
  step: number | null
  cost: number | null
  /** Undefined for the value that the others are compared with. */
  change?: number | null
}

/** A case as it was searched, then by each other means. */
function rowsOf(item: Validation): Row[] {
  const { half_step: half, integrator, again, repeats } = item
  const lowest = repeats ? Math.min(...repeats.values.filter((v) => v !== null)) : NaN
  const rows: (Omit<Row, 'item' | 'number'> | null | undefined | false)[] = [
    { text: again || repeats ? 'As searched' : 'Run step, RK4', step: item.step, cost: item.cost },
    half && { text: again ? 'Half step' : 'Half step, RK4', step: half.step, cost: half.cost, change: half.difference },
    integrator && { text: integrator.name, step: null, cost: integrator.cost, change: integrator.difference },
    again && { text: again.name.charAt(0).toUpperCase() + again.name.slice(1), step: null, cost: again.cost, change: again.difference },
    repeats && { text: `Lowest of ${count(repeats.values.length)} independent calls`, step: null, cost: Number.isFinite(lowest) ? lowest : null },
  ]
  return rows.flatMap((row) => row || []).map((row, number) => ({ ...row, item, number }))
}

const isOver = ({ change, item }: Row): boolean => typeof change === 'number' && item.allowed !== null && Math.abs(change) > item.allowed

function Case({ row: { item, number }, worst }: { row: Row; worst: string }) {
  if (number === 0) return item.name === 'nominal' ? 'Nominal' : item.name === worst ? `Worst, ${worst}` : item.name
  if (number === 1) return <span className={item.ok ? 'small sec' : 'small unk-t'}>{validatedWord(item)}</span>
  return number === 2 && item.realisation !== null && <span className="small mut">noise seed {item.realisation}</span>
}

/** A signed difference with two significant digits. */
function signedSmall(value: number): string {
  if (value === 0) return '0'
  return Math.abs(value) < 1e-4 ? `${value > 0 ? '+' : ''}${plain(value, 2)}` : signed(value, decimalsFor([value], 2))
}
