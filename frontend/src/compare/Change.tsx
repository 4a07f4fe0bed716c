// The change of verdict and worst case from the first run to the others, in one sentence.
import { upperFirst } from '@mantine/hooks'
import { tally } from '../format/names'
import { decimalsFor, fixed, margin } from '../format/numbers'
import { Sign } from '../ui/Sign'
import { lookOf, type Outcome, OutcomeIcon, outcomeOf, wordOf } from '../ui/VerdictBadge'
import { type Compared, unitOf } from './data'
import { OtherCode } from './OtherCode'
import { cards } from '../ui/styles'

export function Change({ runs }: { runs: Compared[] }) {
  const [a, b] = runs
  if (!a || !b) return null
  const outcomes = runs.map(({ run }) => outcomeOf(run))
  const outcome = runs.length === 2 ? outcomeOf(b.run) : gravest(outcomes)
  const words = runs.map(({ run }) => wordOf(run).toLowerCase())
  const same = words.every((word) => word === words[0])
  return (
    <section className={cards.banner} data-tone={lookOf(outcome).tone} aria-label="Change of the verdict">
      <OutcomeIcon outcome={outcome} />
      <div>
        <div className={cards.w} data-testid="change">
          {same
            ? `${runs.length === 2 ? 'Both' : `All ${runs.length}`} ${words[0]}`
            : runs.length === 2
              ? `From ${words[0]} to ${words[1]}`
              : counted(words)}
        </div>
        {runs.length === 2 ? <Two a={a} b={b} /> : <Many runs={runs} />}
        <OtherCode runs={runs.map(({ run }) => run)} />
      </div>
    </section>
  )
}

function Two({ a, b }: { a: Compared; b: Compared }) {
  const unit = unitOf([a, b])
  const [before, after] = [a.run.worst_cost, b.run.worst_cost]
  if (unit === null) return <p>The runs have different criteria: their values cannot be compared.</p>
  if (before === null || after === null) return <p>At least one of the runs has no worst case.</p>
  const decimals = decimalsFor([before, after])
  const apart = after - before
  const difference = fixed(Math.abs(apart), decimalsFor([apart], 3))
  const moved = Math.abs(apart) < 1e-9 * Math.max(1, Math.abs(before))
  const margins = [a.run.margin, b.run.margin]
  const level = moved && a.run.threshold === b.run.threshold
  return (
    <p>
      The worst <Sign text={b.run.quantity || 'value'} /> {moved ? 'is the same' : apart < 0 ? 'falls' : 'rises'}
      {!moved && (
        <>
          {' '}
          by <b>{`${difference} ${unit}`}</b>, from {fixed(before, decimals)} {unit} to <b>{`${fixed(after, decimals)} ${unit}`}</b>
        </>
      )}
      ; the margin {level ? 'stays' : `goes from ${margin(margins[0], decimals)} to`} {margin(margins[1], decimals)} {unit}.{' '}
      {a.run.campaign_digest === b.run.campaign_digest && 'Both are runs of the same campaign.'}
    </p>
  )
}

function Many({ runs }: { runs: Compared[] }) {
  const unit = unitOf(runs)
  if (unit === null) return <p>The runs have different criteria: their values cannot be compared.</p>
  const known = runs.filter(({ run }) => run.margin !== null)
  const without = runs.filter(({ run }) => run.margin === null).map(({ letter }) => letter)
  const lowest = Math.min(...known.map(({ run }) => run.margin ?? Infinity))
  return (
    <p>
      {known.length === 0 ? (
        'None of the runs has a margin.'
      ) : (
        <>
          The smallest margin is that of <b>{known.find(({ run }) => run.margin === lowest)?.letter}</b>:{' '}
          {margin(lowest, decimalsFor([lowest]))} {unit}
          {without.length > 0 && `; ${without.join(', ')} ${without.length === 1 ? 'has' : 'have'} none`}.
        </>
      )}
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
