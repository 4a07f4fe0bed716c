// Margins by finding: the same case in each run side by side, independent of its rank.
import { decimalsFor, NONE, plain, signed } from '../format/numbers'
import { Card } from '../ui/Card'
import { type Compared, unitOf } from './data'
import { APART, type Case, matched } from './matching'
import { RunHeads } from './Picks'
import tables from '../ui/tables.module.css'

export function FindingMargins({ runs, className }: { runs: Compared[]; className: string | undefined }) {
  const unit = unitOf(runs)
  const placed = matched(runs)
  const cases = placed ?? ranked(runs)
  const two = runs.length === 2 && unit !== null && placed !== null
  const decimals = decimalsFor(cases.flat().flatMap((finding) => finding?.margin ?? []))
  const how = placed
    ? `the same case: no parameter further apart than ${plain(100 * APART)} % of its range`
    : 'the runs vary different parameters: ordered by margin, not by position'
  return (
    <Card
      title="Margin of each finding"
      note={`${unit ?? 'units differ'}; ${how}`}
      className={className}
      flush
      id="findings"
    >
      <table className={tables.table}>
        <thead>
          <tr>
            <RunHeads runs={runs} apart={two} />
          </tr>
        </thead>
        <tbody>
          {cases.map((one, i) => {
            const [a, b] = one
            return (
              <tr key={i} data-case={one.map((finding) => finding?.label ?? '').join(' ')}>
                {one.map((finding, k) => (
                  <td key={k} className={finding && finding.margin <= 0 ? 'num bad-t b' : 'num'}>
                    {finding ? (
                      <>
                        <span className="mono mut small">{finding.label}</span> {signed(finding.margin, decimals)}
                      </>
                    ) : (
                      <span className="mut">not among its findings</span>
                    )}
                  </td>
                ))}
                {two && <td className="num b">{a && b ? signed(b.margin - a.margin, decimals) : NONE}</td>}
              </tr>
            )
          })}
        </tbody>
      </table>
    </Card>
  )
}

/** The worst of each run side by side, then the second worst. */
function ranked(runs: Compared[]): Case[] {
  const most = Math.max(0, ...runs.map(({ findings }) => findings.length))
  return Array.from({ length: most }, (_, i) => runs.map(({ findings }) => findings[i] ?? null))
}
