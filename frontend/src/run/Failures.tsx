// Evaluations that gave no value: which, why, and with which parameters.
import { useState } from 'react'
import { count, plain } from '../format/numbers'
import { Card } from '../ui/Card'
import { Sign } from '../ui/Sign'
import type { RunData } from './data'

const FIRST = 12

export function Failures({ data, className }: { data: RunData; className: string }) {
  const { run, parameters, evaluations } = data
  const [all, setAll] = useState(false)
  const failures = evaluations?.failures ?? []
  const shown = all ? failures : failures.slice(0, FIRST)
  const total = run.stages.reduce((sum, stage) => sum + stage.failed + stage.excluded, 0)
  return (
    <Card
      title="Failed and excluded evaluations"
      note={`${count(total)} in all; a failed evaluation bars cleared`}
      className={className}
      id="failures"
      flush
      footer={
        failures.length > FIRST && (
          <span className="row" style={{ justifyContent: 'space-between' }}>
            {count(shown.length)} of {count(total)} shown
            <button type="button" className="btn s" onClick={() => setAll(!all)}>
              {all ? `Show the first ${FIRST}` : `Show ${count(failures.length)}`}
            </button>
          </span>
        )
      }
    >
      <table className="tight">
        <thead>
          <tr>
            <th>Stage</th>
            <th className="num">Evaluation</th>
            <th>Status</th>
            <th>Reason</th>
            {parameters.map((p) => (
              <th key={p.path} className="num">
                <Sign text={p.symbol} />
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {shown.map((failure) => {
            const stage = run.stages.find((s) => s.position === failure.position)
            return (
              <tr key={`${failure.position}-${failure.index}`}>
                <td>{stage?.method ?? stage?.kind}</td>
                <td className="num sec">{count(failure.index + 1)}</td>
                <td>{failure.status}</td>
                <td className="sec">{failure.reason}</td>
                {parameters.map((p) => (
                  <td key={p.path} className="num">
                    {plain(failure.parameters[p.path])}
                  </td>
                ))}
              </tr>
            )
          })}
        </tbody>
      </table>
    </Card>
  )
}
