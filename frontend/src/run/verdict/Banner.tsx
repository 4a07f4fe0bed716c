// The outcome of a run: verdict, sentence, scope and checks. A failed run has no verdict.
import { IconCircleCheck, IconCircleX, IconHelpCircle } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { Fragment } from 'react'
import type { DescribedCheck, RunDetail } from '../../client'
import { withoutValue } from '../../format/counts'
import { count } from '../../format/numbers'
import { words } from '../../format/spans'
import { HelpLink } from '../../help/links'
import { RunLink } from '../../ui/RunLink'
import { Spans } from '../../ui/Spans'
import { lookOf, type Outcome, OutcomeIcon, outcomeOf, shownAs, wordOf } from '../../ui/VerdictBadge'
import type { RunData } from '../data/data'
import { NextSteps } from './NextSteps'
import { cards, layout } from '../../ui/styles'
import styles from './verdict.module.css'

export function Banner({ data }: { data: RunData }) {
  const { run } = data
  const outcome = outcomeOf(run)
  const { summary } = run
  const { tone } = lookOf(shownAs(run))
  return (
    <section className={cards.banner} data-tone={tone} aria-label="Verdict" role={run.verdict ? undefined : 'alert'}>
      <OutcomeIcon outcome={shownAs(run)} />
      <div>
        <div className={cards.w} data-testid="verdict">
          {run.verdict ? wordOf(run) : `${wordOf(run)}: no verdict`}
        </div>
        <span className={styles.bannerHelp}>
          <HelpLink to="/help" at={outcome}>
            What this means
          </HelpLink>
          <HelpLink to="/help/evidence">What a verdict rests on</HelpLink>
        </span>
        {run.verdict ? (
          <p>
            <Spans spans={summary?.statement ?? [words(run.reason ?? '')]} />
          </p>
        ) : (
          <WithoutVerdict run={run} outcome={outcome} />
        )}
        <Against run={run} />
        {run.rules && <p data-testid="rules">{run.rules}</p>}
        {run.verdict && summary?.sureness && (
          <p className="sec" data-testid="sureness">
            <Spans spans={[...summary.sureness.statement, words('.')]} />
          </p>
        )}
        {run.verdict && summary && summary.holds_for.length > 0 && (
          <details className={clsx('sec', styles.scope)}>
            <summary className={clsx('sec', layout.cut)}>
              Scope: <Spans spans={summary.holds_for} exact />
            </summary>
          </details>
        )}
        {run.verdict === 'inconclusive' && <NextSteps run={run} />}
        {run.verdict && summary && summary.checks.length > 0 && (
          <Checks checks={summary.checks} succeeded={succeededOf(run)} earlier={run.earlier_rules} />
        )}
      </div>
    </section>
  )
}

/** Which other runs speak against the verdict: the first few, and all on demand. */
export function Against({ run: { against, against_runs: all = [] } }: { run: RunDetail }) {
  if (!against) return null
  return (
    <div data-testid="against">
      <p>
        <b>{against}</b>
      </p>
      {all.length > (against.match(/R-\d+/g)?.length ?? 0) && (
        <details className="sec">
          <summary>All {count(all.length)} runs</summary>
          <p>
            {all.map((id) => (
              <Fragment key={id}>
                <RunLink run={id} />{' '}
              </Fragment>
            ))}
          </p>
        </details>
      )}
    </div>
  )
}

interface ChecksProps {
  checks: readonly DescribedCheck[]
  succeeded: number
  /** Of a run that earlier rules cleared: those of today require others. */
  earlier: boolean
}

/**
 * Folded, so that verdict, figures and 3D view fit on one screen; the line that unfolds it names every check that does not
 * hold, and every one that holds only for the evaluations that have a value.
 */
export function Checks(props: ChecksProps) {
  const { checks } = props
  return (
    <details className={clsx('sec', styles.fold)} data-testid="checks">
      <summary className="sec">
        <Tally {...props} />
      </summary>
      <ul className={styles.checks} aria-label="Checks">
        {checks.map((check) => (
          <li key={check.name} data-check={check.name} data-standing={check.standing}>
            <Standing check={check} />
            <span>
              <span className="m">{check.title}</span>:{' '}
              <Spans spans={check.limit.length > 0 ? [...check.statement, words('; '), ...check.limit] : check.statement} />
            </span>
          </li>
        ))}
      </ul>
    </details>
  )
}

function Tally({ checks, succeeded, earlier }: ChecksProps) {
  const of = (standing: DescribedCheck['standing']) => checks.filter((check) => check.standing === standing)
  const [failing, open] = [of('fails'), of('open')]
  return (
    <>
      <b>
        {failing.length === 0
          ? open.length === 0 && `All ${checks.length} checks ${earlier ? 'of that version ' : ''}hold`
          : `${failing.length} of ${checks.length} checks ${failing.length === 1 ? 'fails' : 'fail'}:`}
      </b>
      {failing.length > 0 && (
        <span>
          <IconCircleX className="i s bad-t" aria-hidden /> {titles(failing)}
        </span>
      )}
      {open.length > 0 && (
        <span>
          <IconHelpCircle className="i s unk-t" aria-hidden /> Holds for the {count(succeeded)} evaluations that did not fail:{' '}
          {titles(open)}
        </span>
      )}
    </>
  )
}

/** The titles of checks; that of the violations as what was found, because the absence of one is what it requires. */
const titles = (checks: readonly DescribedCheck[]): string =>
  checks.map(({ name, title, standing }) => (name === 'no violation' && standing === 'fails' ? 'a violation was found' : title)).join(', ')

/** The evaluations that have a value. */
const succeededOf = (run: RunDetail): number => run.evaluations - run.failed_evaluations - run.excluded_evaluations

/** Green only if no evaluation failed: failed ones have no value for which the check could hold. */
export function Standing({ check }: { check: Pick<DescribedCheck, 'standing'> }) {
  if (check.standing === 'holds') return <IconCircleCheck className="i s ok-t" aria-label="holds" />
  if (check.standing === 'open')
    return <IconHelpCircle className="i s unk-t" aria-label="holds for the evaluations that have a value" />
  return <IconCircleX className="i s bad-t" aria-label="does not hold" />
}

/** Converts stored text or spans to a sentence. */
const sentence = (text: string): string => `${text.charAt(0).toUpperCase()}${text.slice(1).replace(/[.\s]+$/, '')}.`

/** Why a run of a concurrency group was cancelled. */
const successor = (run: RunDetail): string =>
  run.superseded_by && run.group ? ` ${run.superseded_by} superseded it in the group ${run.group}.` : ''

/** Why there is no verdict, and the lowest value where it is at or below the threshold. */
export function WithoutVerdict({ run, outcome }: { run: RunDetail; outcome: Outcome }) {
  return (
    <>
      <p>{reasonOf(run, outcome)}</p>
      {run.unconfirmed.length > 0 && (
        <p data-testid="unconfirmed">
          <Spans spans={run.unconfirmed} exact />
        </p>
      )}
    </>
  )
}

function reasonOf(run: RunDetail, outcome: Outcome): string {
  if (outcome === 'cancelled' && run.evaluations === 0)
    return `The run was cancelled before its first evaluation ended.${successor(run)} There are no results.`
  if (outcome === 'cancelled')
    return `The run was cancelled after ${count(run.evaluations)} evaluations, ${withoutValue(run)}; the run would take at most ${count(run.planned)}.${successor(run)} Completed evaluations are shown below${run.unconfirmed.length > 0 ? '' : '; they support no claim about the avoidance system'}.`
  // The reason of a run that failed after several attempts already states how many.
  const attempts = run.attempts > 1 && !run.error?.includes('attempt') ? ` It was tried ${run.attempts} times.` : ''
  return `${sentence(run.error ?? 'the run ended without a verdict')}${attempts}${run.unconfirmed.length > 0 ? '' : ' This is not a result about the avoidance system.'}`
}
