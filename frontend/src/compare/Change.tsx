// The verdicts and worst cases of the runs in a few sentences; a change is stated only where more than the search differs.
import { upperFirst } from '@mantine/hooks'
import { useQuery } from '@tanstack/react-query'
import { codeQuery } from '../api/queries'
import { tally } from '../format/names'
import { decimalsFor, fixed, margin } from '../format/numbers'
import { Sign } from '../ui/Sign'
import { Spans } from '../ui/Spans'
import { lookOf, type Outcome, OutcomeIcon, shownAs, wordOf } from '../ui/VerdictBadge'
import { type Cause, causeText, otherQuestion } from './cause'
import { type Compared, isDone, unitOf } from './data'
import { differences } from './differences'
import { OtherCode } from './OtherCode'
import { cards } from '../ui/styles'

export function Change({ runs }: { runs: Compared[] }) {
  const [a, b] = runs
  const cause = useCause(runs)
  if (!a || !b) return null
  const outcomes = runs.map(({ run }) => shownAs(run))
  const changed = cause !== null && isChange(a, b, cause)
  const outcome = changed ? shownAs(b.run) : gravest(outcomes)
  return (
    <section className={cards.banner} data-tone={lookOf(outcome).tone} aria-label="Change of the verdict">
      <OutcomeIcon outcome={outcome} />
      <div>
        <div className={cards.w} data-testid="change">{titleOf(runs, changed)}</div>
        {cause ? <Two a={a} b={b} cause={cause} /> : <Many runs={runs} />}
        {runs.map(({ letter, run }) => run.against && (
          <p key={letter} data-testid="against">
            Against {letter}: <b>{run.against}</b>
          </p>
        ))}
        <OtherCode runs={runs.map(({ run }) => run)} />
      </div>
    </section>
  )
}

/** Null for more than two runs. */
function useCause(runs: Compared[]): Cause | null {
  const [a, b] = runs
  const two = runs.length === 2
  const { data } = useQuery({ ...codeQuery(b?.id ?? '', a?.id ?? ''), enabled: two && runs.every(isDone) })
  return two ? { question: otherQuestion(differences(runs)), code: data } : null
}

/** Whether the second run is of something else than the first, so that a verdict can have changed. Of two of which one
 * speaks against the other, the other missed a case. */
const isChange = (a: Compared, b: Compared, { question, code }: Cause): boolean =>
  isDone(a) && isDone(b) && !a.run.against_runs?.includes(b.id) && !b.run.against_runs?.includes(a.id) &&
  ((question.length > 0 && code?.same_question !== true) || code?.same_model === false || a.run.threshold !== b.run.threshold)

function titleOf(runs: Compared[], changed: boolean): string {
  const words = runs.map(({ run }) => wordOf(run).toLowerCase())
  if (words.every((word) => word === words[0])) return `${runs.length === 2 ? 'Both' : `All ${runs.length}`} ${words[0]}`
  if (runs.length > 2) return counted(words)
  return changed ? `From ${words[0]} to ${words[1]}` : runs.map(({ letter }, k) => `${letter} ${words[k]}`).join('; ')
}

const DIFFERENT = 'The runs have different criteria: their values cannot be compared.'

function Two({ a, b, cause }: { a: Compared; b: Compared; cause: Cause }) {
  const unit = unitOf([a, b])
  const [before, after] = [a.run.worst_cost, b.run.worst_cost]
  if (unit === null) return <p>{DIFFERENT}</p>
  if (!isDone(a) || !isDone(b)) return <p>{[a, b].map((of) => <Alone key={of.letter} of={of} />)}</p>
  if (before === null || after === null) return <p>At least one of the runs has no worst case.</p>
  const decimals = decimalsFor([before, after])
  const apart = after - before
  const difference = fixed(Math.abs(apart), decimalsFor([apart], 3))
  const moved = Math.abs(apart) >= 1e-9 * Math.max(1, Math.abs(before))
  const margins = [a.run.margin, b.run.margin].map((value) => `${margin(value, decimals)} ${unit}`.trim())
  const name = <Sign text={b.run.quantity || 'value'} />
  return (
    <p>
      {moved ? (
        <>
          The worst {name} is {fixed(before, decimals)} {unit} in A and <b>{`${fixed(after, decimals)} ${unit}`.trim()}</b> in B,{' '}
          <b>{`${difference} ${unit}`.trim()}</b> {apart < 0 ? 'lower' : 'higher'}
        </>
      ) : (
        <>The worst {name} is the same</>
      )}
      ; the margin is {!moved && a.run.threshold === b.run.threshold ? margins[0] : `${margins[0]} in A and ${margins[1]} in B`}.{' '}
      {a.run.campaign_digest === b.run.campaign_digest && 'Both are runs of the same campaign. '}
      {moved && <span data-testid="cause">{causeText(cause, apart > 0)}</span>}
    </p>
  )
}

const ENDS = { queued: 'is queued', running: 'is running', cancelling: 'is being cancelled', cancelled: 'was cancelled', failed: 'failed' }

/** The lowest value of one run. Of one that is not done it is what has been found so far, with which nothing is compared. */
function Alone({ of: { letter, run } }: { of: Compared }) {
  const name = <Sign text={run.quantity || 'value'} />
  const value = run.worst_cost === null ? null : `${fixed(run.worst_cost, decimalsFor([run.worst_cost]))} ${run.unit}`.trim()
  if (run.state === 'done') return value === null ? `${letter} has no worst case. ` : <>The worst {name} of {letter} is {value}. </>
  const ended = run.state === 'cancelled' || run.state === 'failed'
  return (
    <>
      {letter} {ENDS[run.state]}: its search {ended ? 'did not end' : 'has not ended'}
      {value !== null && <>, and the lowest {name} so far is {value}</>}.{' '}
      {run.unconfirmed.length > 0 && <><Spans spans={run.unconfirmed} /> </>}
    </>
  )
}

function Many({ runs }: { runs: Compared[] }) {
  const unit = unitOf(runs)
  if (unit === null) return <p>{DIFFERENT}</p>
  const done = runs.filter(isDone)
  const known = done.filter(({ run }) => run.margin !== null)
  const without = done.filter(({ run }) => run.margin === null).map(({ letter }) => letter)
  const lowest = Math.min(...known.map(({ run }) => run.margin ?? Infinity))
  return (
    <p>
      {known.length === 0 ? (
        'None of the runs that are done has a margin. '
      ) : (
        <>
          The smallest margin{done.length < runs.length && ' of the runs that are done'} is that of{' '}
          <b>{known.find(({ run }) => run.margin === lowest)?.letter}</b>: {margin(lowest, decimalsFor([lowest]))} {unit}
          {without.length > 0 && `; ${without.join(', ')} ${without.length === 1 ? 'has' : 'have'} none`}.{' '}
        </>
      )}
      {runs.map((of) => !isDone(of) && <Alone key={of.letter} of={of} />)}
    </p>
  )
}

/** What several runs together are no better than: cleared only if all are. */
export const gravest = (outcomes: readonly Outcome[]): Outcome =>
  outcomes.find((one) => one === 'violated') ??
  outcomes.find((one) => one !== 'cleared' && one !== 'inconclusive') ??
  outcomes.find((one) => one === 'inconclusive') ??
  'cleared'

const counted = (words: string[]): string => upperFirst([...tally(words)].map(([word, n]) => `${n} ${word}`).join(', '))
