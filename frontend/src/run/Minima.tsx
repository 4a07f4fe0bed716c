// Where each start of a local method ended: its start, the minimum it reached, what it cost, why it stopped there.
import type { SearchResult } from '../api/results'
import { count, decimalsApart, decimalsFor, fixed, NONE } from '../format/numbers'
import { unitText } from '../format/units'
import { Card } from '../ui/Card'
import { MethodName } from '../ui/MethodMark'
import { Sign } from '../ui/Sign'
import type { RunData } from './data'

const MOST = 40

interface MinimaProps {
  data: RunData
  search: SearchResult
  className: string
  /** Starts above their ends instead of beside them: for many parameters. */
  tall?: boolean
}

export function Minima({ data, search, className, tall }: MinimaProps) {
  const { run, parameters } = data
  const costs = search.minima.map((minimum) => minimum.cost)
  const decimals = decimalsApart(costs, 5, 6)
  const lowest = Math.min(...costs)
  const rows = search.minima.slice(0, MOST)
  return (
    <Card
      title="Minima by start"
      note={
        <>
          <MethodName method={search.method} title={search.title} />
          {tall && ' Start above, end below'}
        </>
      }
      className={className}
      flush
      footer={search.minima.length > MOST ? `The first ${MOST} of ${count(search.minima.length)}.` : undefined}
    >
      <table className="tight">
        <thead>
          <tr>
            <th className="num">Start</th>
            {parameters.map((p) => (
              <th key={p.path} className="num">
                <Sign text={p.symbol} />
                <br />
                <span className="u">{unitText(p.unit)}</span>
              </th>
            ))}
            <th className="num">
              <Sign text={run.quantity || 'value'} />
              <br />
              <span className="u">{run.unit}</span>
            </th>
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
                    <span className="mut">
                      {minimum.start ? fixed(minimum.start[p.path], digits) : NONE} {tall ? '' : '→ '}
                    </span>
                    {tall && <br />}
                    {fixed(minimum.parameters[p.path], digits)}
                  </td>
                )
              })}
              <td className={minimum.cost === lowest ? 'num b' : 'num'}>{fixed(minimum.cost, decimals)}</td>
              <td className="num sec">{count(minimum.evaluations)}</td>
              <td className="sec">{minimum.text}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </Card>
  )
}
