// Evaluations without a value: counts by kind, reasons, and parameters, which can be copied as YAML.
import { clsx } from 'clsx'
import { useState } from 'react'
import type { EvaluationFailure } from '../../client'
import { count, decimalsFor, fixed } from '../../format/numbers'
import { unitText } from '../../format/units'
import { Card, NumHead } from '../../ui/Card'
import { CopyButton } from '../../ui/files'
import { Sign } from '../../ui/Sign'
import type { RunData } from '../data/data'
import { countsOf, MEANING, startsYaml } from './failed'
import buttons from '../../ui/buttons.module.css'
import layout from '../../ui/layout.module.css'
import tables from '../../ui/tables.module.css'
import styles from './search.module.css'

const FIRST = 12

export function Failures({ data, className }: { data: RunData; className: string | undefined }) {
  const { run, evaluations } = data
  const [all, setAll] = useState(false)
  const failures = evaluations?.failures ?? []
  const shown = all ? failures : failures.slice(0, FIRST)
  const counts = countsOf(run.stages, evaluations)
  const total = counts.reduce((sum, { count }) => sum + count, 0)
  return (
    <Card
      title="Evaluations without a value"
      note={`${count(total)} of ${count(run.evaluations)}`}
      className={className}
      id="failures"
      flush
      footer={
        failures.length > FIRST && (
          <span className={layout.row} style={{ justifyContent: 'space-between' }}>
            {count(shown.length)} of {count(total)} shown
            {failures.length < total && `; the first ${failures.length} are shown here; the CSV file contains all`}
            <button type="button" className={clsx(buttons.btn, buttons.s)} onClick={() => setAll(!all)}>
              {all ? `Show the first ${FIRST}` : `Show ${count(failures.length)}`}
            </button>
          </span>
        )
      }
    >
      <ul className={styles.fates}>
        {counts.map(({ status, count: number }) => (
          <li key={status}>
            <b>{count(number)}</b> {MEANING[status].name}
            <span className="mut">: {MEANING[status].text}</span>
          </li>
        ))}
      </ul>
      <table className={clsx(tables.table, tables.tight)}>
        <thead>
          <tr>
            <th>Stage</th>
            <th className="num">Evaluation</th>
            <th>Status</th>
            <th>Reason</th>
            {data.parameters.map((p) => (
              <NumHead key={p.path} unit={unitText(p.unit)} title={p.text}>
                <Sign text={p.symbol} path={p.path} />
              </NumHead>
            ))}
            <th>
              <span className="sr">Copy</span>
            </th>
          </tr>
        </thead>
        <tbody>
          {shown.map((failure) => (
            <Row key={`${failure.position}-${failure.index}`} data={data} failure={failure} />
          ))}
        </tbody>
      </table>
    </Card>
  )
}

function Row({ data, failure }: { data: RunData; failure: EvaluationFailure }) {
  const { run, parameters, catalogue } = data
  const stage = run.stages.find((s) => s.position === failure.position)
  const title = catalogue?.methods.find((method) => method.name === stage?.method)?.title ?? stage?.method
  return (
    <tr>
      <td className="nw">{title ?? run.plan.find(({ kind }) => kind === stage?.kind)?.title ?? stage?.kind}</td>
      <td className="num sec">{count(failure.index + 1)}</td>
      <td className="nw">{MEANING[failure.status].word}</td>
      <td className={clsx('sec', styles.reason)}>{failure.reason}</td>
      {parameters.map((p) => (
        <td key={p.path} className="num">
          {fixed(failure.parameters[p.path], decimalsFor([p.low, p.high], 5))}
        </td>
      ))}
      <td className="num">
        <CopyButton text={() => startsYaml(failure.parameters)}>Copy as YAML</CopyButton>
      </td>
    </tr>
  )
}
