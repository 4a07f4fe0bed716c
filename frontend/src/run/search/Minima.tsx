// The minima of a method: starts and ends of a local method, only the lowest ends of any other.
import { useState } from 'react'
import type { SearchResult } from '../../client'
import { count, decimalsApart, decimalsFor, fixed, NONE } from '../../format/numbers'
import { unitText } from '../../format/units'
import { Card, NumHead } from '../../ui/Card'
import { MethodName } from '../../ui/MethodMark'
import { Said } from '../../ui/Said'
import { Sign } from '../../ui/Sign'
import type { RunData } from '../data/data'

/** Maximum number of listed starts. */
const SHOWN = 12
const MOST = 40

/** Number of rows initially shown. */
export const rowsOf = (search: SearchResult): number =>
  Math.min(search.minima.length, search.kind === 'local' ? SHOWN : FEW)

/** For a method that starts its own descents. */
const FEW = 5

interface MinimaProps {
  data: RunData
  search: SearchResult
  className: string
  /** Starts above their ends instead of next to them, for many parameters. */
  tall?: boolean
}

export function Minima({ data, search, className, tall }: MinimaProps) {
  const { run, parameters } = data
  const costs = search.minima.map((minimum) => minimum.cost)
  const decimals = decimalsApart(costs, 5, 6)
  const lowest = Math.min(...costs)
  // A method that starts from its own sample reports no starts: then only the ends are shown.
  const started = search.kind === 'local'
  const [all, setAll] = useState(false)
  const most = all ? MOST : started ? SHOWN : FEW
  const rows = (started ? search.minima : [...search.minima].sort((a, b) => a.cost - b.cost)).slice(0, most)
  return (
    <Card
      title={started ? 'Minima by start' : 'Local minima'}
      note={
        <>
          <MethodName method={search.method} title={search.title} />
          {started ? tall && ' Start above, end below' : ' The lowest first'}
        </>
      }
      className={className}
      flush
      footer={
        search.minima.length > (started ? SHOWN : FEW) && (
          <span className="row" style={{ justifyContent: 'space-between' }}>
            The {started ? 'first' : 'lowest'} {rows.length} of {count(search.minima.length)}
            <button type="button" className="btn s" onClick={() => setAll(!all)}>
              {all ? 'Show fewer' : `Show ${Math.min(MOST, search.minima.length)}`}
            </button>
          </span>
        )
      }
    >
      <table className="tight">
        <thead>
          <tr>
            <th className="num">{started ? 'Start' : 'No.'}</th>
            {parameters.map((p) => (
              <NumHead key={p.path} unit={unitText(p.unit)}>
                <Sign text={p.symbol} path={p.path} />
              </NumHead>
            ))}
            <NumHead unit={run.unit}><Sign text={run.quantity || 'value'} /></NumHead>
            <th className="num">Evaluations</th>
            <th>Ended</th>
          </tr>
        </thead>
        <tbody>
          {rows.map((minimum, i) => (
            <tr key={i}>
              <td className="num sec">{i + 1}</td>
              {parameters.map((p) => {
                const digits = decimalsFor([p.low, p.high])
                return (
                  <td key={p.path} className="num">
                    {started && (
                      <span className="mut">
                        {minimum.start ? fixed(minimum.start[p.path], digits) : NONE} {tall ? '' : '→ '}
                      </span>
                    )}
                    {started && tall && <br />}
                    {fixed(minimum.parameters[p.path], digits)}
                  </td>
                )
              })}
              <td className={minimum.cost === lowest ? 'num b' : 'num'}>{fixed(minimum.cost, decimals)}</td>
              <td className="num sec">{count(minimum.evaluations)}</td>
              <td className="sec"><Said spans={minimum.said} /></td>
            </tr>
          ))}
        </tbody>
      </table>
    </Card>
  )
}
