// One run in the list. What it shows depends on how far the run has come.
import { Link, useNavigate } from '@tanstack/react-router'
import { type MouseEvent, useEffect, useRef } from 'react'
import type { RunSummary } from '../client'
import { count, decimalsFor, duration, fixed, NONE, signed } from '../format/numbers'
import { moment, when } from '../format/time'
import { MarginBar } from '../ui/bars'
import { Progress } from '../ui/Card'
import { MethodName } from '../ui/MethodMark'
import { outcomeOf, VerdictBadge } from '../ui/VerdictBadge'

interface RunRowProps {
  run: RunSummary
  chosen: boolean
  /** Units stand in the cells because the rows differ. */
  units: boolean
  now: number
  onTag: (tag: string) => void
}

export function RunRow({ run, chosen, units, now, onTag }: RunRowProps) {
  const row = useRef<HTMLTableRowElement>(null)
  const navigate = useNavigate()
  const outcome = outcomeOf(run)
  useEffect(() => {
    if (chosen) row.current?.scrollIntoView({ block: 'nearest' })
  }, [chosen])
  const open = (event: MouseEvent) => {
    const target = event.target as HTMLElement
    if (!target.closest('a, button') && !getSelection()?.toString())
      void navigate({ to: '/runs/$id', params: { id: run.id } })
  }
  return (
    <tr ref={row} className={chosen ? 'sel' : undefined} aria-selected={chosen} onClick={open} data-run={run.id}>
      <td>
        <span className="rn">
          <Link to="/runs/$id" params={{ id: run.id }}>
            {run.name}
          </Link>
          <small className="nw">
            {run.id}
            {run.campaign_name !== run.name && ` · ${run.campaign_name}`}
          </small>
        </span>
      </td>
      <td>
        <VerdictBadge outcome={outcome} />
      </td>
      {run.verdict ? <Result run={run} units={units} /> : <Standing run={run} now={now} />}
      <td>
        {run.tags.map((tag) => (
          <button key={tag} type="button" className="tag" onClick={() => onTag(tag)} title={`Show runs tagged ${tag}`}>
            {tag}
          </button>
        ))}
      </td>
      <td className="num sec hide-n">{run.started ? duration((run.finished ?? now) - run.started) : NONE}</td>
      <td className="nw sec">
        <time dateTime={new Date(run.created * 1000).toISOString()} title={moment(run.created)}>
          {when(run.created, now)}
        </time>
      </td>
    </tr>
  )
}

function Result({ run, units }: { run: RunSummary; units: boolean }) {
  const decimals = decimalsFor([run.worst_cost, run.threshold])
  const unit = units && run.unit ? ` ${run.unit}` : ''
  const violated = run.margin !== null && run.margin <= 0
  return (
    <>
      <td className="num m">
        {fixed(run.worst_cost, decimals)}
        {unit}
      </td>
      <td className="num sec">
        {run.threshold ?? NONE}
        {unit}
      </td>
      <td className={violated ? 'num b bad-t' : 'num m'}>
        {signed(run.margin, decimals)}
        {unit}
      </td>
      <td className="bar">
        {run.margin !== null && run.threshold ? <MarginBar margin={run.margin} threshold={run.threshold} /> : null}
      </td>
      <td>{run.worst_method ? <MethodName method={run.worst_method} short /> : <span className="mut">{NONE}</span>}</td>
      <td className="num sec">{count(run.evaluations)}</td>
    </>
  )
}

const STAGE: Record<string, string> = {
  nominal: 'Nominal',
  sensitivity: 'Sensitivity',
  search: 'Search',
  certify: 'Certify',
  validate: 'Validate',
}

/** A run without a verdict: how far it is, or why it ended. */
function Standing({ run, now }: { run: RunSummary; now: number }) {
  if (run.state === 'queued')
    return (
      <td colSpan={6} className="sec">
        Waiting for a worker
      </td>
    )
  if (run.state === 'failed' || run.state === 'cancelled' || run.state === 'done')
    return (
      <td colSpan={6} className="sec reason" title={run.error ?? run.reason ?? ''}>
        {run.error ??
          run.reason ??
          (run.state === 'cancelled' ? `Cancelled after ${count(run.evaluations)} evaluations` : '')}
      </td>
    )
  const share = run.planned > 0 ? run.evaluations / run.planned : 0
  const elapsed = run.started ? now - run.started : 0
  const left = share > 0.02 && run.state === 'running' ? (elapsed * (1 - share)) / share : null
  const stage = run.stage ? (STAGE[run.stage.kind] ?? run.stage.kind) : 'Starting'
  return (
    <td colSpan={6}>
      <span className="standing">
        <span style={{ width: 140 }}>
          <Progress share={share} label={`Progress of ${run.id}`} />
        </span>
        <span className="b">
          {stage}, {Math.round(100 * share)} %
        </span>
        <span className="mut">
          {left !== null && left > 1 && `about ${duration(left)} left`}
          {run.worst_cost !== null &&
            `${left !== null && left > 1 ? ' · ' : ''}best so far ${fixed(run.worst_cost, decimalsFor([run.worst_cost]))} ${run.unit}`}
        </span>
      </span>
    </td>
  )
}
