// Evaluations without a value: counts by kind, reasons, and parameters, which can be copied as YAML.
import { clsx } from 'clsx'
import { useState } from 'react'
import type { EvaluationFailure } from '../../client'
import { count, decimalsFor, fixed } from '../../format/numbers'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { CopyButton } from '../../ui/files'
import { buttonColumn, Table } from '../../ui/Table'
import type { RunData } from '../data/data'
import { parameterColumns } from '../parameters/columns'
import { countsOf, MEANING, startsYaml } from './failed'
import { layout } from '../../ui/styles'
import styles from './search.module.css'

const FIRST = 12

export function Failures({ data }: { data: RunData }) {
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
      className={layout.c12}
      id="failures"
      flush
      footer={
        failures.length > FIRST && (
          <span className={layout.row} style={{ justifyContent: 'space-between' }}>
            {count(shown.length)} of {count(total)} shown
            {failures.length < total && `; ${count(failures.length)} can be shown here, and the CSV file has all that are stored`}
            <Button small onClick={() => setAll(!all)}>
              {all ? `Show the first ${FIRST}` : `Show ${count(failures.length)}`}
            </Button>
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
      <Table
        tight
        rows={shown}
        by={({ position, index }) => `${position}-${index}`}
        columns={[
          { head: 'Stage', tone: 'nw', cell: ({ position }) => stageTitle(data, position) },
          { head: 'Index', num: true, tone: 'sec', cell: ({ index }) => count(index) },
          { head: 'Status', tone: 'nw', cell: ({ status }) => MEANING[status].word },
          { head: 'Reason', tone: clsx('sec', styles.reason), cell: ({ reason }) => reason },
          ...parameterColumns<EvaluationFailure>(data.parameters, ({ parameters }, p) => fixed(parameters[p.path], decimalsFor([p.low, p.high], 5)), 'text'),
          buttonColumn<EvaluationFailure>('Copy', ({ parameters }) => (
            <CopyButton text={() => startsYaml(parameters)}>Copy as YAML</CopyButton>
          )),
        ]}
      />
    </Card>
  )
}

function stageTitle({ run, catalogue }: RunData, position: number) {
  const stage = run.stages.find((each) => each.position === position)
  const title = catalogue?.methods.find((method) => method.name === stage?.method)?.title ?? stage?.method
  return title ?? run.plan.find(({ kind }) => kind === stage?.kind)?.title ?? stage?.kind
}
