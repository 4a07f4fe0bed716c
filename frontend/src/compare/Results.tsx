// The results of the runs side by side, with the difference for two runs.
import type { ReactNode } from 'react'
import { independentSample } from '../api/stages'
import { conditionsOf } from '../format/counts'
import { atMost, confidenceText, count, decimalsBeside, exact, fixed, margin, NONE, plain, probability, signed } from '../format/numbers'
import { Card } from '../ui/Card'
import { Sign } from '../ui/Sign'
import { Table } from '../ui/Table'
import { RunBadge } from '../ui/VerdictBadge'
import { type Compared, haveDifferences, unitOf } from './data'
import { apartColumn, foundColumns } from './Picks'

interface Line {
  key: string
  name: ReactNode
  unit: string
  values: (number | null)[]
  decimals: number
  /** Which values are a violation. */
  bad?: (value: number) => boolean
  /** How a value is written; by default with the line's decimals. */
  text?: (value: number | null, decimals: number) => string
  /** How the difference of two values is written, by default with the line's decimals; null if they have none. */
  apart?: ((difference: number) => string) | null
  /** The total of each value, if totals differ: then no difference is shown. */
  outOf?: (number | null)[]
  /** What follows a value, if anything. */
  notes?: string[]
}

export function Results({ runs }: { runs: Compared[] }) {
  const two = haveDifferences(runs)
  return (
    <Card title="Results" flush id="results">
      <Table
        rows={linesOf(runs).filter(({ values }) => values.some((value) => value !== null))}
        row={({ key }) => ({ 'data-row': key })}
        columns={[
          { head: '', cell: ({ name, unit }) => <>{name} <span className="mut small">{unit}</span></> },
          ...foundColumns<Line>(
            runs,
            (line, k) => <Value line={line} run={k} />,
            ({ values, bad }, k) => values[k] != null && bad?.(values[k]) && 'bad-t b',
          ),
          two && apartColumn(apartText),
        ]}
        first={
          <tr>
            <td>Verdict</td>
            {runs.map(({ run }) => (
              <td key={run.id} className="num">
                <RunBadge run={run} />
              </td>
            ))}
            {two && <td />}
          </tr>
        }
      />
    </Card>
  )
}

function Value({ line: { values, decimals, text = fixed, outOf, notes }, run }: { line: Line; run: number }) {
  const value = values[run]
  return (
    <>
      {text(value ?? null, decimals)}
      {value != null && outOf && <span className="mut small"> of {count(outOf[run])}</span>}
      {value != null && notes?.[run] && <span className="mut small"> {notes[run]}</span>}
    </>
  )
}

function apartText({ values: [a, b], outOf, decimals, apart }: Line): string {
  if (typeof a !== 'number' || typeof b !== 'number' || outOf || apart === null) return NONE
  return apart ? apart(b - a) : signed(b - a, decimals)
}

function linesOf(runs: Compared[]): Line[] {
  const unit = unitOf(runs) ?? ''
  const quantity = unitOf(runs) === null ? 'value' : (runs[0]?.run.quantity || 'value')
  const decimals = Math.max(...runs.map(({ run }) => decimalsBeside([run.worst_cost, run.nominal_cost], run.threshold)))
  const samples = runs.map(({ stages }) => independentSample(stages))
  const statistics = runs.map(({ run }) => run.summary?.statistics ?? null)
  const sizes = [...new Set(statistics.flatMap((sample) => (sample ? [sample.samples] : [])))]
  const confidences = [...new Set(statistics.flatMap((sample) => sample?.confidence ?? []))]
  const level = new Set(runs.map(({ run }) => run.threshold)).size === 1
  const percent = (difference: number) => `${difference > 0 ? '+' : ''}${probability(difference)}`
  return [
    { key: 'worst', name: <>Worst <Sign text={quantity} /></>, unit, decimals, values: runs.map(({ run }) => run.worst_cost) },
    { key: 'criterion', name: 'Criterion', unit, decimals, values: runs.map(({ run }) => run.threshold), text: (limit) => exact(limit), apart: (by) => `${by > 0 ? '+' : ''}${plain(by)}` },
    { key: 'margin', name: 'Margin', unit, decimals, values: runs.map(({ run }) => run.margin), bad: (v) => v <= 0, text: margin, apart: (by) => margin(by, decimals) },
    { key: 'nominal', name: <>Nominal <Sign text={quantity} /></>, unit, decimals, values: runs.map(({ run }) => run.nominal_cost) },
    { key: 'lowest', name: 'Lowest sample', unit, decimals, values: samples.map((sample) => sample?.lowest ?? null) },
    {
      key: 'violations',
      name: statistics.some((sample) => sample?.failed) ? 'Samples in violation or failed' : 'Samples in violation',
      unit: sizes.length === 1 ? `of ${count(sizes[0])}` : '',
      outOf: sizes.length > 1 ? statistics.map((sample) => sample?.samples ?? null) : undefined,
      decimals: 0,
      values: statistics.map((sample) => sample?.violations ?? null),
      apart: level ? undefined : null,
      bad: (v) => v > 0,
    },
    {
      key: 'bound',
      name: `P(violation), ${confidences.length === 1 ? `${confidenceText(confidences[0])} ` : ''}bound`,
      unit: '',
      decimals: 0,
      values: statistics.map((sample) => sample?.upper_bound ?? null),
      notes: runs.map(({ run }) => conditionsOf(run)),
      text: (bound) => atMost(bound),
      apart: level && confidences.length === 1 ? percent : null,
    },
    { key: 'closest', name: 'Closest approach at', unit: 's', decimals: 2, values: runs.map(({ worst }) => worst?.meta.closest?.time ?? null) },
    { key: 'evaluations', name: 'Evaluations', unit: '', decimals: 0, values: runs.map(({ run }) => run.evaluations) },
    { key: 'failed', name: 'Failed', unit: '', decimals: 0, values: runs.map(({ run }) => run.failed_evaluations), bad: (v) => v > 0 },
    { key: 'excluded', name: 'Excluded', unit: '', decimals: 0, values: runs.map(({ run }) => run.excluded_evaluations) },
  ]
}
