// Verdict and state as icon, word and colour together, so that none of the three is needed alone.
import {
  IconAlertTriangle,
  IconBan,
  IconCircleCheck,
  IconCircleX,
  IconClock,
  IconHelpCircle,
  IconLoader,
} from '@tabler/icons-react'
import { clsx } from 'clsx'
import type { HTMLAttributes } from 'react'
import type { RunSummary } from '../client'
import { badges, icons } from './styles'

export type Outcome = 'cleared' | 'violated' | 'inconclusive' | Exclude<RunSummary['state'], 'done'>

const LOOK = {
  cleared: { tone: 'ok', word: 'Cleared', Icon: IconCircleCheck },
  violated: { tone: 'bad', word: 'Violated', Icon: IconCircleX },
  inconclusive: { tone: 'unk', word: 'Inconclusive', Icon: IconHelpCircle },
  queued: { tone: 'que', word: 'Queued', Icon: IconClock },
  running: { tone: 'run', word: 'Running', Icon: IconLoader },
  cancelling: { tone: 'run', word: 'Cancelling', Icon: IconLoader },
  cancelled: { tone: 'err', word: 'Cancelled', Icon: IconBan },
  failed: { tone: 'err', word: 'Failed', Icon: IconAlertTriangle },
} as const

/** The outcome of a run: its verdict if there is one, else its state. */
export function outcomeOf(run: Pick<RunSummary, 'state' | 'verdict'>): Outcome {
  return run.verdict ?? (run.state === 'done' ? 'inconclusive' : run.state)
}

/** The outcome of which a run has icon and colour: a cleared one that other runs speak against has no tick. */
export const shownAs = (run: Pick<RunSummary, 'state' | 'verdict'> & Partial<Pick<RunSummary, 'against'>>): Outcome =>
  run.verdict === 'cleared' && run.against ? 'inconclusive' : outcomeOf(run)

export const lookOf = (outcome: Outcome) => LOOK[outcome]

export function OutcomeIcon({ outcome, className = 'i' }: { outcome: Outcome; className?: string }) {
  const { Icon } = LOOK[outcome]
  const busy = outcome === 'running' || outcome === 'cancelling'
  return <Icon className={clsx(className, busy && icons.spin)} aria-hidden="true" />
}

type Ended = Pick<RunSummary, 'state' | 'verdict'> & Partial<Pick<RunSummary, 'not_sampled' | 'earlier_rules' | 'against' | 'policy'>>

function lacking(run: Ended): string {
  const marks = [run.not_sampled && 'not sampled', run.earlier_rules && 'earlier rules', run.against && 'contradicted'].filter(Boolean)
  return run.verdict && marks.length > 0 ? `: ${marks.join(', ')}` : ''
}

const failing = ({ policy }: Ended) => (policy === 'fails' ? ', policy fails' : '')

/** The outcome in words, with what alone is missing to clear the run, that earlier rules cleared it, that other runs speak against it, and that its policy on changes fails. */
export const wordOf = (run: Ended): string => `${LOOK[outcomeOf(run)].word}${lacking(run)}${failing(run)}`

/** The same verdict within a sentence, null without one. */
export const headlineOf = (run: Ended): string | null => run.verdict && `${run.verdict}${lacking(run)}${failing(run)}`

interface BadgeProps extends HTMLAttributes<HTMLSpanElement> {
  tone: string
  Icon: typeof IconCircleCheck
}

export const Badge = ({ tone, Icon, children, ...rest }: BadgeProps) => (
  <span className={clsx('b', badges.vd)} data-tone={tone} {...rest}>
    <Icon className="i" aria-hidden />
    {children}
  </span>
)

/** title: which other runs speak against the verdict. */
export const RunBadge = ({ run }: { run: Ended }) => (
  <VerdictBadge outcome={shownAs(run)} word={wordOf(run)} title={run.against || undefined} />
)

export function VerdictBadge({ outcome, word = LOOK[outcome].word, title }: { outcome: Outcome; word?: string; title?: string | undefined }) {
  const { tone } = LOOK[outcome]
  return (
    <span className={clsx('b', badges.vd)} data-tone={tone} title={title}>
      <OutcomeIcon outcome={outcome} />
      {word}
    </span>
  )
}
