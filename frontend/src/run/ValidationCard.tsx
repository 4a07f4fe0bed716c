// Validation: the same flights by half the step, by another integrator, and next to the worst case.
import { IconCircleCheck, IconCircleX } from '@tabler/icons-react'
import type { ValidateResult, ValidationCase } from '../api/results'
import { count, decimalsFor, fixed, NONE, percent, plain, signed } from '../format/numbers'
import { Card, NumHead } from '../ui/Card'
import { Sign } from '../ui/Sign'
import type { RunData } from './data'
import { Said } from './Said'

export function ValidationCard({
  data,
  result,
  className,
}: {
  data: RunData
  result: ValidateResult
  className: string
}) {
  const { run } = data
  const neighbours = result.cases.find((c) => c.neighbours)?.neighbours
  const decimals = decimalsFor(
    result.cases.map((c) => c.cost),
    7,
  )
  const other = result.cases[0]?.integrator.name ?? 'Other'
  return (
    <Card
      title="Validation"
      note="The same flights by other means"
      className={className}
      id="validation"
      flush
      right={
        <span className={`vd ${result.ok ? 'ok' : 'unk'}`}>
          {result.ok ? <IconCircleCheck className="i" aria-hidden /> : <IconCircleX className="i" aria-hidden />}
          {result.ok ? 'Passed' : 'Not passed'}
        </span>
      }
      footer={
        <>
          <Said data={data} text={sentence(result.text)} /> Tolerance {percent(result.tolerance)} of the value, and a tenth of the margin.{' '}
          {neighbours && (
            <>
              {count(neighbours.flown)} neighbours of the worst case were flown
              {neighbours.failed > 0 && `, ${count(neighbours.failed)} of them failed`}:{' '}
              {neighbours.lower_by
                ? `the lowest is ${plain(neighbours.lower_by, 3)} ${run.unit} lower and became the worst case.`
                : 'none is lower.'}
            </>
          )}
        </>
      }
    >
      <table className="tight">
        <thead>
          <tr>
            <th>Flight</th>
            <th>Integration</th>
            <NumHead unit="ms">Step</NumHead>
            <NumHead unit={run.unit}><Sign text={run.quantity || 'value'} /></NumHead>
            <NumHead unit={run.unit}>Change</NumHead>
            <NumHead unit={run.unit}>Allowed</NumHead>
          </tr>
        </thead>
        <tbody>
          {result.cases.map((c) => (
            <Rows key={c.name} item={c} decimals={decimals} other={other} />
          ))}
        </tbody>
      </table>
    </Card>
  )
}

const sentence = (text: string): string => `${text.charAt(0).toUpperCase()}${text.slice(1)}.`

function Rows({ item, decimals, other }: { item: ValidationCase; decimals: number; other: string }) {
  const name = item.name === 'nominal' ? 'Nominal' : item.name === 'F1' ? 'Worst, F1' : item.name
  const rows = [
    { key: 'run', text: 'Run step, RK4', step: item.step, cost: item.cost, change: undefined },
    {
      key: 'half',
      text: 'Half step, RK4',
      step: item.half_step.step,
      cost: item.half_step.cost,
      change: item.half_step.difference,
    },
    { key: 'other', text: other, step: null, cost: item.integrator.cost, change: item.integrator.difference },
  ]
  return rows.map((row, i) => {
    const over = typeof row.change === 'number' && item.allowed !== null && Math.abs(row.change) > item.allowed
    return (
      <tr key={row.key}>
        <td className="m">{i === 0 ? name : ''}</td>
        <td className="sec">{row.text}</td>
        <td className="num sec">{row.step === null ? 'adaptive' : plain(row.step * 1000)}</td>
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

/** A difference, however small, with two digits and its sign. */
function signedSmall(value: number): string {
  if (value === 0) return '0'
  return Math.abs(value) < 1e-4 ? `${value > 0 ? '+' : ''}${plain(value, 2)}` : signed(value, decimalsFor([value], 2))
}
