// The stages of a run in a row, grouped by kind, and the verdict.
import { IconAlertTriangle, IconBan, IconCircleCheck, IconCircleDashed, IconLoader } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { isLive } from '../../api/queries'
import type { RunDetail, SoFar, StageProgress, StageSummary } from '../../client'
import { lossesOf, shareOf } from '../../format/counts'
import { atMost, count, decimalsFor, duration, exact, fixed } from '../../format/numbers'
import { Progress } from '../../ui/Card'
import { methodLook } from '../../ui/methods'
import { headlineOf } from '../../ui/VerdictBadge'
import { cards, icons, layout } from '../../ui/styles'
import styles from './search.module.css'

type State = 'done' | 'act' | 'todo' | 'fail'

interface Step {
  name: string
  state: State
  figures: string
  /** Evaluations without a value. */
  losses: string
  text: string
  /** The same in full. */
  whole?: string | undefined
  share: number
}

export function StageStrip({ run }: { run: RunDetail }) {
  return (
    <div className={clsx(cards.card, styles.stages)} role="list" aria-label="Stages">
      {stepsOf(run).map((step) => (
        <div key={step.name} className={styles.stg} data-state={step.state} role="listitem">
          <div className={clsx(layout.row, 'b nw', styles.nm)}>
            <StepIcon state={step.state} cancelled={run.state === 'cancelled'} />
            {step.name}
            <span className="micro mut">
              {step.figures}
              {step.losses && (
                <>
                  , <span className="unk-t">{step.losses}</span>
                </>
              )}
            </span>
          </div>
          <div className={clsx('mut', layout.cut, styles.dt)} title={step.whole ?? step.text}>
            {step.text}
          </div>
          <Progress
            share={step.share}
            colour={step.state === 'done' ? 'var(--ok-solid)' : undefined}
            label={`${step.name}, progress`}
          />
        </div>
      ))}
    </div>
  )
}

function StepIcon({ state, cancelled }: { state: State; cancelled: boolean }) {
  if (state === 'done') return <IconCircleCheck className="i" aria-label="done" />
  if (state === 'act') return <IconLoader className={clsx(icons.spin, 'i')} aria-label="running" />
  if (state === 'fail')
    return cancelled ? (
      <IconBan className="i" aria-label="cancelled" />
    ) : (
      <IconAlertTriangle className="i" aria-label="failed" />
    )
  return <IconCircleDashed className="i" aria-label="waiting" />
}

function stepsOf(run: RunDetail): Step[] {
  const steps = run.plan.map((kind) =>
    step(
      run,
      kind,
      run.stages.filter((stage) => stage.kind === kind.kind),
    ),
  )
  const verdict = run.verdict !== null
  steps.push({
    name: 'Verdict',
    state: verdict ? 'done' : 'todo',
    losses: '',
    figures: verdict ? '' : isLive(run) ? 'waiting' : 'none',
    text: headlineOf(run) ?? (isLive(run) ? 'cleared, violated or inconclusive' : 'no verdict'),
    share: verdict ? 1 : 0,
  })
  return steps
}

function step(run: RunDetail, kind: StageSummary, stages: StageProgress[]): Step {
  const flown = stages.reduce((sum, stage) => sum + stage.evaluations, 0)
  const planned = stages.reduce((sum, stage) => sum + stage.planned, 0)
  const whole = stages.reduce((sum, stage) => sum + Math.max(stage.planned, stage.evaluations + stage.left), 0)
  const ended = stages.length > 0 && stages.every((stage) => stage.state === 'done')
  const begun = stages.some((stage) => stage.state !== 'waiting')
  const state: State = ended ? 'done' : begun ? (isLive(run) ? 'act' : 'fail') : 'todo'
  const share = ended ? 1 : stages.reduce((sum, stage) => sum + shareOf(stage), 0) / Math.max(1, stages.length)
  return {
    name: kind.title,
    state,
    figures: ended
      ? `${count(flown)} done`
      : begun
        ? `${count(flown)} of ${whole > planned ? 'about ' : ''}${count(whole)}`
        : isLive(run)
          ? 'waiting'
          : 'not started',
    losses: lossesOf(stages),
    text: textOf(run, kind, stages),
    whole: stages.find((stage) => stage.so_far)?.so_far?.text,
    share,
  }
}

function textOf(run: RunDetail, kind: StageSummary, stages: StageProgress[]): string {
  const running = stages.find((stage) => stage.state === 'running')
  if (running?.so_far) return boundSoFar(running, running.so_far)
  if (running?.method) {
    const { title } = methodLook(running.method)
    return stages.length > 1 ? `${title}, ${stages.indexOf(running) + 1} of ${kind.description}` : title
  }
  const [only] = stages
  // A stage of a single evaluation shows its cost.
  if (stages.length === 1 && only?.state === 'done' && only.planned === 1 && only.best !== null) return costText(run, only.best)
  return kind.description
}

/** The bound of a sample as it falls, and where it will be when the sample is drawn. */
export function boundSoFar({ evaluations, left, seconds }: StageProgress, { violations, failed, upper_bound, at_end, within_bounds }: SoFar): string {
  const what = failed > 0 ? `violate or failed (${count(failed)} failed)` : violations === 1 ? 'violation' : 'violations'
  const seen = violations > 0 ? `${count(violations)} ${what}, ` : ''
  const time = duration((left * seconds) / Math.max(1, evaluations))
  return `${seen}P${within_bounds ? ' within the bounds' : ''} ≤ ${atMost(upper_bound, 2)}, ${atMost(at_end, 2)} in ${time} if no other violates`
}

function costText({ threshold, unit }: RunDetail, cost: number): string {
  const value = `${fixed(cost, decimalsFor([cost]))} ${unit}`
  return threshold === null ? value : `${value}, ${cost > threshold ? 'clear of' : 'not above'} ${exact(threshold)} ${unit}`
}
