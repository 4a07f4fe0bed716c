// The results of the runs side by side, with the difference for two runs.
import type { ReactNode } from 'react'
import { count, decimalsFor, fixed, NONE, signed } from '../format/numbers'
import { Card } from '../ui/Card'
import { Sign } from '../ui/Sign'
import { outcomeOf, VerdictBadge } from '../ui/VerdictBadge'
import { boundOf, type Compared, sampleOf, unitOf } from './data'
import { RunHeads } from './Picks'
import tables from '../ui/tables.module.css'

interface Line {
  key: string
  name: ReactNode
  unit: string
  values: (number | null)[]
  decimals: number
  /** Which values are a violation. */
  bad?: (value: number) => boolean
  plus?: boolean
  /** The total of each value, if totals differ: then no difference is shown. */
  outOf?: (number | null)[]
}

export function Results({ runs, className }: { runs: Compared[]; className: string | undefined }) {
  const two = runs.length === 2 && unitOf(runs) !== null
  return (
    <Card title="Results" className={className} flush id="results">
      <table className={tables.table}>
        <thead>
          <tr>
            <th />
            <RunHeads runs={runs} apart={two} />
          </tr>
        </thead>
        <tbody>
          <tr>
            <td>Verdict</td>
            {runs.map(({ run }) => (
              <td key={run.id} className="num">
                <VerdictBadge outcome={outcomeOf(run)} />
              </td>
            ))}
            {two && <td />}
          </tr>
          {linesOf(runs).filter(({ values }) => values.some((value) => value !== null)).map((line) => (
            <Row key={line.key} line={line} difference={two} />
          ))}
        </tbody>
      </table>
    </Card>
  )
}

function Row({ line, difference }: { line: Line; difference: boolean }) {
  const [a, b] = line.values
  const apart = typeof a === 'number' && typeof b === 'number' && !line.outOf ? b - a : null
  return (
    <tr data-row={line.key}>
      <td>
        {line.name} <span className="mut small">{line.unit}</span>
      </td>
      {line.values.map((value, i) => (
        <td key={i} className={value !== null && line.bad?.(value) ? 'num bad-t b' : 'num'}>
          {line.plus ? signed(value, line.decimals) : fixed(value, line.decimals)}
          {value !== null && line.outOf && <span className="mut small"> of {count(line.outOf[i] ?? null)}</span>}
        </td>
      ))}
      {difference && <td className="num b">{apart === null ? NONE : signed(apart, line.decimals)}</td>}
    </tr>
  )
}

function linesOf(runs: Compared[]): Line[] {
  const unit = unitOf(runs) ?? ''
  const quantity = unitOf(runs) === null ? 'value' : (runs[0]?.run.quantity ?? 'value')
  const costs = runs.flatMap(({ run }) => [run.worst_cost, run.nominal_cost])
  const decimals = decimalsFor(costs)
  const samples = runs.map(sampleOf)
  const statistics = runs.map(({ run }) => run.summary?.statistics ?? null)
  const sizes = [...new Set(statistics.flatMap((told) => (told ? [told.samples] : [])))]
  const bounds = runs.map((compared) => {
    const bound = boundOf(compared)
    return bound === null ? null : 100 * bound
  })
  const confidence = statistics.find((told) => told !== null)?.confidence
  return [
    { key: 'worst', name: <>Worst <Sign text={quantity} /></>, unit, decimals, values: runs.map(({ run }) => run.worst_cost) },
    { key: 'criterion', name: 'Criterion', unit, decimals, values: runs.map(({ run }) => run.threshold) },
    { key: 'margin', name: 'Margin', unit, decimals, values: runs.map(({ run }) => run.margin), bad: (v) => v <= 0, plus: true },
    { key: 'nominal', name: <>Nominal <Sign text={quantity} /></>, unit, decimals, values: runs.map(({ run }) => run.nominal_cost) },
    { key: 'lowest', name: 'Lowest sample', unit, decimals, values: samples.map((sample) => sample?.lowest ?? null) },
    {
      key: 'violations',
      name: 'Samples in violation',
      unit: sizes.length === 1 ? `of ${count(sizes[0])}` : '',
      outOf: sizes.length > 1 ? statistics.map((told) => told?.samples ?? null) : undefined,
      decimals: 0,
      values: statistics.map((told) => told?.violations ?? null),
      bad: (v) => v > 0,
    },
    {
      key: 'bound',
      name: `P(violation), ${confidence === undefined ? '' : `${count(confidence * 100)} % `}bound`,
      unit: '%',
      decimals: decimalsFor(bounds, 4),
      values: bounds,
    },
    { key: 'closest', name: 'Closest approach at', unit: 's', decimals: 2, values: runs.map(({ worst }) => worst?.meta.closest?.time ?? null) },
    { key: 'evaluations', name: 'Evaluations', unit: '', decimals: 0, values: runs.map(({ run }) => run.evaluations) },
    { key: 'failed', name: 'Failed', unit: '', decimals: 0, values: runs.map(({ run }) => run.failed_evaluations), bad: (v) => v > 0 },
    { key: 'excluded', name: 'Excluded', unit: '', decimals: 0, values: runs.map(({ run }) => run.excluded_evaluations) },
  ]
}
