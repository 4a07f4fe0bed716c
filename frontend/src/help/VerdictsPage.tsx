// The meaning and requirements of each verdict, and what it does not mean.
import { Link } from '@tanstack/react-router'
import type { ReactNode } from 'react'
import { CHECKS } from '../api/rules'
import { useTitle } from '../page/useTitle'
import { Card } from '../ui/Card'
import { type Outcome, VerdictBadge } from '../ui/VerdictBadge'
import { HelpFrame, Passage, Terms } from './HelpFrame'

interface Meaning {
  outcome: Outcome
  says: ReactNode
  takes?: readonly ReactNode[]
  not: ReactNode
}

const MEANINGS: readonly Meaning[] = [
  {
    outcome: 'violated',
    says: 'A case within the stated bounds reaches or violates the criterion, and validation confirmed it.',
    takes: [
      'A finding with a margin of zero or less.',
      'The same case also violates the criterion in the step-halving check and with the reference integrator. If the three differ by more than the tolerance, the verdict reports it.',
    ],
    not: 'It does not report how often this happens: see the bound on P(violation). A violation can exist that a thousand random samples never meet.',
  },
  {
    outcome: 'cleared',
    says: 'No evaluation reaches the criterion, and the search was thorough enough to support the verdict.',
    takes: CHECKS.map(({ requires }) => requires),
    not: 'It is not a proof. A search can miss a worse case, and the verdict holds only for this model, these bounds and this criterion. The verdict’s sentence and scope name them.',
  },
  {
    outcome: 'inconclusive',
    says: 'The evidence supports neither of the two. The verdict’s sentence gives the reason, and the failed check is marked.',
    not: 'It does not mean nearly violated. Usual reasons: two methods disagree, a budget was too small, the step is too coarse, evaluations failed, or the sample is too small for the target.',
  },
]

const UNCONFIRMED =
  'A value at or below the threshold that it found is stated all the same: it speaks against a requirement, although no verdict confirms it.'

const STATES: readonly Meaning[] = [
  {
    outcome: 'failed',
    says: 'The run itself failed after up to three attempts, or after it had lost ten workers. Its page shows the reason.',
    not: `The failure is not a result about the avoidance system. ${UNCONFIRMED}`,
  },
  {
    outcome: 'cancelled',
    says: 'Cancelled by a user, or by the next run of its concurrency group. Completed evaluations are kept.',
    not: `A cancelled run has no verdict. ${UNCONFIRMED}`,
  },
]

const TERMS: readonly [string, ReactNode][] = [
  ['Criterion', 'What every evaluation must meet, such as a minimum separation. The margin is the value less the criterion.'],
  [
    'Finding',
    'One distinct worst case: a separate valley in the parameter space, polished and validated. Two minima count as one if they are close together or there is no barrier between them.',
  ],
  [
    'P(violation)',
    'The probability that a case drawn from the stated distributions violates the criterion. The bound comes from independent points of a declared number, in a cleared run from a sample of its own whose seed was drawn at launch, not chosen by a user (Clopper and Pearson 1934).',
  ],
  ['Failed evaluation', 'A simulation that leaves the model’s envelope or becomes non-finite. It has no value, is counted, and rules out Cleared.'],
  [
    'Contradicted',
    'Next to a verdict: another run, with the same question and model or with other bounds around the case, violates, found a value at or below the threshold, or saw beyond the horizon what bars Cleared. Removed runs do not count.',
  ],
  ['Excluded evaluation', 'An evaluation whose scenario is invalid, such as one that starts inside the safety radius. It cannot be evaluated.'],
  ['Validation', 'The same case at half the step and with the reference integrator (DOP853), and a few hundred of its neighbours. A lower neighbour replaces the finding. Stored violations and random evaluations are simulated again as well.'],
]

export function VerdictsPage() {
  useTitle('Help')
  const contents = [
    { title: 'Verdicts', entries: MEANINGS.map(({ outcome }) => ({ id: outcome, name: <VerdictBadge outcome={outcome} /> })) },
    { title: 'No verdict', entries: STATES.map(({ outcome }) => ({ id: outcome, name: <VerdictBadge outcome={outcome} /> })) },
    { title: 'Words', entries: [{ id: 'words', name: 'What the words mean' }] },
  ]
  return (
    <HelpFrame
      title="Verdicts"
      lede={
        <>
          A run searches for the worst case within the bounds of the uncertain parameters, and reports what may be claimed. Nothing
          is cleared by one family of <Link to="/help/methods">methods</Link>, or by a bound alone.{' '}
          <Link to="/help/evidence">What a verdict rests on and how it was attacked</Link>
        </>
      }
      contents={contents}
    >
      {[...MEANINGS, ...STATES].map((meaning) => (
        <Passage key={meaning.outcome} id={meaning.outcome} title={<VerdictBadge outcome={meaning.outcome} />}>
          <p>{meaning.says}</p>
          {meaning.takes && (
            <>
              <p className="b">Requires all of these</p>
              <ul>
                {meaning.takes.map((take, i) => (
                  <li key={i}>{take}</li>
                ))}
              </ul>
            </>
          )}
          <p className="sec">
            <span className="b">What it does not mean:</span> {meaning.not}
          </p>
        </Passage>
      ))}
      <Card title="What the words mean" id="words">
        <Terms of={TERMS.map(([word, text]) => ({ word, text }))} />
      </Card>
    </HelpFrame>
  )
}
