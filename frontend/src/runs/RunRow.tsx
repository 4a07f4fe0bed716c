// One row of the run list; its content depends on the state of the run.
import { clsx } from 'clsx'
import { useNavigate } from '@tanstack/react-router'
import { memo, type MouseEvent } from 'react'
import { useStill } from '../api/still'
import type { RunSummary } from '../client'
import { shareOf } from '../format/counts'
import { count, decimalsFor, duration, fixed } from '../format/numbers'
import { age } from '../format/time'
import { Progress } from '../ui/Card'
import { type CellContext, RunName } from './cells'
import { type Column, COLUMNS } from './columns'
import { fields, layout } from '../ui/styles'
import styles from './runs.module.css'

interface RunRowProps extends CellContext {
  run: RunSummary
  columns: readonly Column[]
  /** Counted from 1, including headers. */
  number: number
  chosen: boolean
  marked: boolean
  onMark: (ids: readonly string[], on: boolean) => void
}

export const RunRow = memo(function RunRow(props: RunRowProps) {
  const { run, columns, number, chosen, marked, onMark } = props
  const navigate = useNavigate()
  const open = (event: MouseEvent) => {
    const target = event.target as HTMLElement
    if (!target.closest('a, button, input, label') && !getSelection()?.toString())
      void navigate({ to: '/runs/$id', params: { id: run.id } })
  }
  const results = columns.filter((column) => column.result)
  return (
    <tr
      className={chosen ? styles.at : marked ? styles.sel : undefined}
      aria-selected={chosen || marked}
      aria-rowindex={number}
      onClick={open}
      data-run={run.id}
    >
      <td className={styles.mark}>
        <label>
          <input
            className={fields.check}
            type="checkbox"
            checked={marked}
            aria-label={`Select ${run.id}`}
            onChange={(event) => onMark([run.id], event.target.checked)}
          />
        </label>
      </td>
      <td>
        <RunName run={run} asides={COLUMNS.flatMap((column) => (!columns.includes(column) && column.aside?.(run)) || [])} />
      </td>
      {columns.map((column) => {
        if (!run.verdict && column.result)
          return column === results[0] ? <Standing key={column.key} run={run} now={props.now} span={results.length} /> : null
        return (
          <td key={column.key} className={column.num ? 'num' : undefined}>
            {column.cell(run, props)}
          </td>
        )
      })}
    </tr>
  )
})

/** A run without a verdict: its progress, or why it ended. */
function Standing({ run, now, span }: { run: RunSummary; now: number; span: number }) {
  if (run.state === 'queued')
    return (
      <Reason text={run.waits ?? 'Waiting for a worker'} span={span} />
    )
  if (run.state === 'failed' || run.state === 'cancelled' || run.state === 'done') {
    const cancelled = run.state === 'cancelled' ? cancelledAfter(run) : ''
    const statement = run.error ?? run.reason ?? cancelled
    const why = statement.charAt(0).toUpperCase() + statement.slice(1)
    return (
      <Reason text={why} span={span} />
    )
  }
  return (
    <td colSpan={span}>
      <Working run={run} now={now} />
    </td>
  )
}

/** On two lines where one is too short; the rest is on the page of the run, and where the pointer rests. */
function Reason({ text, span }: { text: string; span: number }) {
  const statement = text.replaceAll('`', '') // commands are marked in text that other pages show as code
  return (
    <td colSpan={span} className="sec" title={statement}>
      <span className={styles.reason}>{statement}</span>
    </td>
  )
}

const cancelledAfter = ({ evaluations }: RunSummary): string =>
  evaluations === 0 ? 'Cancelled before its first evaluation' : `Cancelled after ${count(evaluations)} evaluations`

/** Progress of the running stage: later stages seldom use their whole budget, so a fraction of the run would mislead. */
function Working({ run, now }: { run: RunSummary; now: number }) {
  const { stage } = run
  const share = stage ? shareOf(stage) : 0
  const name = run.doing ? 'Compiling' : stage ? stage.title : 'Starting'
  const best = run.worst_cost
  const since = useStill(run.id)
  return (
    <span className={clsx(layout.row, 'nw', styles.standing)}>
      <span style={{ width: 120 }}>
        <Progress share={share} label={`Progress of ${run.id}`} />
      </span>
      <span className="b">
        {name}
        {!run.doing && stage && stage.planned > 1 ? `, ${Math.round(100 * share)} %` : ''}
      </span>
      <span className={clsx(layout.cut, 'mut')}>
        {since !== null && <span className="bad-t">{`no new evaluation for ${age(Math.max(0, now - since))} · `}</span>}
        {run.doing?.seconds != null && `about ${age(Math.ceil(run.doing.seconds))}, once · `}
        {run.started !== null && `${duration(Math.max(0, now - run.started))} so far`}
        {best !== null && ` · best so far ${fixed(best, decimalsFor([best]))} ${run.unit}`}
      </span>
    </span>
  )
}
