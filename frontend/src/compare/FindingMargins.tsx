// Margins by finding: the same case in each run side by side, independent of its rank.
import { decimalsFor, margin, NONE, plain, signed } from '../format/numbers'
import { Card } from '../ui/Card'
import { Table } from '../ui/Table'
import { type Compared, haveDifferences, unitOf } from './data'
import { APART, type Case, matched } from './matching'
import { apartColumn, foundColumns } from './Picks'

export function FindingMargins({ runs }: { runs: Compared[] }) {
  const unit = unitOf(runs)
  const placed = matched(runs)
  const cases = placed ?? ranked(runs)
  const two = haveDifferences(runs) && placed !== null
  const decimals = decimalsFor(cases.flat().flatMap((finding) => finding?.margin ?? []))
  const how = placed
    ? `the same case: no parameter further apart than ${plain(100 * APART)} % of its range`
    : 'the runs vary different parameters, or those of different parts: ordered by margin, not by position'
  return (
    <Card
      title="Margin of each finding"
      note={`${unit ?? 'units differ'}; ${how}`}
      flush
      id="findings"
    >
      <Table
        rows={cases}
        row={(one) => ({ 'data-case': one.map((finding) => finding?.label ?? '').join(' ') })}
        columns={[
          ...foundColumns<Case>(
            runs,
            (one, k) => <Margin finding={one[k]} decimals={decimals} />,
            (one, k) => (one[k]?.margin ?? 1) <= 0 && 'bad-t b',
          ),
          two && apartColumn<Case>(([a, b]) => (a && b ? signed(b.margin - a.margin, decimals) : NONE)),
        ]}
      />
    </Card>
  )
}

function Margin({ finding, decimals }: { finding: Case[number] | undefined; decimals: number }) {
  if (!finding) return <span className="mut">not among its findings</span>
  return (
    <>
      <span className="mono mut small">{finding.label}</span> {margin(finding.margin, decimals)}
    </>
  )
}

/** The worst of each run side by side, then the second worst. */
function ranked(runs: Compared[]): Case[] {
  const most = Math.max(0, ...runs.map(({ findings }) => findings.length))
  return Array.from({ length: most }, (_, i) => runs.map(({ findings }) => findings[i] ?? null))
}
