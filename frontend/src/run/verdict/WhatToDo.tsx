// Advice for a failed run.
import { Link } from '@tanstack/react-router'
import type { RunDetail } from '../../client'
import { Card } from '../../ui/Card'
import { methodLook } from '../../ui/methods'
import { Retry } from '../header/Retry'
import styles from './verdict.module.css'

/** Stages that every run has. */
const NEEDED: ReadonlySet<string> = new Set(['nominal', 'validate'])

export function WhatToDo({ run, className }: { run: RunDetail; className: string | undefined }) {
  const stage = run.stages.find(({ state }) => state === 'running')
  const begun = run.stages.some(({ state }) => state !== 'waiting')
  return (
    <Card title="What to do" className={className}>
      <ol className={styles.todoList}>
        {!begun && (
          <li>
            <b>Change what the message names,</b> in the campaign on the <Link to="/launch" search={{ from: run.id }}>launch page</Link>{' '}
            or in the installation of the worker: the run failed before its first stage, so as it is it will fail again.
          </li>
        )}
        {run.removed === null && <li>
          <b>Retry it</b> once the cause is mended, such as a full disk or a machine that was switched off: it goes on from what is
          stored, or makes all evaluations again if none has a value. <Retry run={run} />
        </li>}
        {begun && <li>
          <b>Run it again</b> with the button above, as it is or changed. If it fails for the same reason
          {stage && ` in ${stage.method ? methodLook(stage.method).title : stage.kind}`}, take a smaller budget or step
          {stage && !NEEDED.has(stage.kind) && ', or omit that stage'}, on the <Link to="/launch" search={{ from: run.id }}>launch page</Link>.
        </li>}
        <li>
          <b>Read the log</b> of the worker{run.worker ? ` (${run.worker})` : ''}, in the folder <code>logs</code> of the
          service’s data: it contains the output of the simulation before it ended.
        </li>
        <li>
          <b>Draw no conclusion.</b> A run that failed has no verdict, whatever it had evaluated until then.
        </li>
      </ol>
    </Card>
  )
}
