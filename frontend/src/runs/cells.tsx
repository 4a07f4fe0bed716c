// The non-numeric cells of the run list.
import { clsx } from 'clsx'
import { IconAlertTriangle, IconPinned } from '@tabler/icons-react'
import { Link } from '@tanstack/react-router'
import type { RunSummary } from '../client'
import { unknownOf } from '../format/counts'
import { decimalsFor, margin, NONE, short } from '../format/numbers'
import { moment, when } from '../format/time'
import { MarginBar } from '../ui/bars'
import type { CellContext } from './columns'
import { badges, layout, tables } from '../ui/styles'
import styles from './runs.module.css'

/** The first column, always shown: name, number, campaign, pin. */
export function RunName({ run, campaign }: { run: RunSummary; campaign: boolean }) {
  return (
    <span className={clsx(tables.rn, styles.rn)}>
      <span className={layout.cut}>
        {run.pinned && <IconPinned className="i s mut" aria-label="Pinned" />}{' '}
        <Link to="/runs/$id" params={{ id: run.id }} title={run.name}>
          {run.name}
        </Link>
      </span>
      <small className={layout.cut}>
        {run.id}
        {campaign && run.campaign_name !== run.name && ` · ${run.campaign_name}`}
        {run.continues && ` · extends ${run.continues}`}
      </small>
    </span>
  )
}

/** A value in the criterion's unit; a power of ten where its column would cut off its last digits. */
export function amount(value: number | null, run: Pick<RunSummary, 'worst_cost' | 'threshold' | 'unit'>, { units }: Pick<CellContext, 'units'>): string {
  const text = short(value, decimalsFor([run.worst_cost, run.threshold]))
  return units && value !== null && run.unit ? `${text} ${run.unit}` : text
}

export function Time({ at, now }: { at: number | null; now: number }) {
  if (at === null) return NONE
  return (
    <time dateTime={new Date(at * 1000).toISOString()} title={moment(at)}>
      {when(at, now)}
    </time>
  )
}

/** Why, when and by whom a run was removed. */
export function Removal({ run, now }: { run: RunSummary; now: number }) {
  return (
    <span className={clsx(tables.rn, styles.rn)} title={run.removed_reason ?? undefined}>
      <span className={layout.cut}>{run.removed_reason}</span>
      <small className={layout.cut}>
        <Time at={run.removed} now={now} /> by {run.removed_by}
      </small>
    </span>
  )
}

export function Margin({ run, context }: { run: RunSummary; context: CellContext }) {
  const violated = run.margin !== null && run.margin <= 0
  const unit = context.units && run.unit ? ` ${run.unit}` : ''
  return (
    <span className={styles.marg}>
      <span className={violated ? 'b bad-t' : 'm'} title={unknownOf(run) || undefined}>
        {unknownOf(run) && (
          <>
            <IconAlertTriangle className="i s unk-t" aria-label={unknownOf(run)} />{' '}
          </>
        )}
        {margin(run.margin, decimalsFor([run.worst_cost, run.threshold]))}
        {unit}
      </span>
      {run.margin !== null && run.threshold ? (
        <MarginBar margin={run.margin} threshold={run.threshold} open={run.failed_evaluations > 0} />
      ) : (
        <span style={{ width: 50 }} />
      )}
    </span>
  )
}

/** Tags and labels of a run as words; what a click on one shows. */
type Word = { text: string; title: string; show: () => void }

/** Those that fit into the column, at least one; widths are estimated from the number of letters. */
function fitting(all: readonly Word[]): readonly Word[] {
  const within = (room: number) => all.findIndex(({ text }) => (room -= text.length + 3) < 0)
  // Where some are left out, their number needs room, too.
  return within(26) < 0 ? all : all.slice(0, Math.max(1, within(22)))
}

interface TagsProps {
  run: RunSummary
  onTag: (tag: string) => void
  onLabel: (label: string) => void
}

export function Tags({ run, onTag, onLabel }: TagsProps) {
  const all: Word[] = [
    ...run.tags.map((tag) => ({ text: tag, title: `Show runs tagged ${tag}`, show: () => onTag(tag) })),
    ...Object.entries(run.labels).map(([key, value]) => {
      const text = `${key}=${value}`
      return { text, title: `Show runs with the label ${text}`, show: () => onLabel(text) }
    }),
  ]
  const shown = fitting(all)
  const more = all.slice(shown.length).map(({ text }) => text)
  return (
    <span className={layout.cut}>
      {shown.map(({ text, title, show }) => (
        <button key={text} type="button" className={clsx(badges.tag, styles.tag)} onClick={show} title={title}>
          {text}
        </button>
      ))}
      {more.length > 0 && (
        <span className="small mut" title={more.join(', ')}>
          {' '}
          +{more.length}
          <span className="sr"> more: {more.join(', ')}</span>
        </span>
      )}
    </span>
  )
}
