// What each verdict means, what it takes, and what it never says.
import { Link } from '@tanstack/react-router'
import type { ReactNode } from 'react'
import { useTitle } from '../page/useTitle'
import { type Outcome, VerdictBadge } from '../ui/VerdictBadge'
import { HelpFrame } from './HelpFrame'

interface Meaning {
  outcome: Outcome
  says: ReactNode
  takes?: readonly ReactNode[]
  not: ReactNode
}

const MEANINGS: readonly Meaning[] = [
  {
    outcome: 'violated',
    says: 'A flight within the stated bounds comes as near as the criterion, or nearer, and it was confirmed by other means.',
    takes: [
      'A finding with a margin of zero or less.',
      'The same flight violates at half the step and with the reference integrator, too. Where the three are beyond tolerance apart, the sentence says so.',
    ],
    not: 'It does not say how often this happens: that is the bound on P(violation). Both can be true: a violation that a thousand random flights never meet.',
  },
  {
    outcome: 'cleared',
    says: 'No flight that was found comes as near as the criterion, and the search was hard enough to be believed.',
    takes: [
      'The nominal flight keeps the criterion.',
      'Every search ended by its own rule or its budget, and no stored evaluation of any stage violates the criterion.',
      'The worst finding is the lowest of all evaluations, and it was polished to the end.',
      'Every global method reaches the worst case within the campaign’s agreement, by default 5 % of nominal minus worst, and at least two methods do.',
      'Half the step and the reference integrator agree, for the nominal flight and every finding, and no random evaluation violates with the reference integrator alone.',
      'No evaluation failed, and at most 10 % were excluded.',
      'The encounter took place: the closest approach is inside the horizon, the vehicle moves, the avoidance makes a difference, and so does a parameter.',
      'With noise, an independent sample draws a realisation with every flight.',
      'Where there is a sample, its bound on P(violation) meets the campaign’s target, or 5 % where none is stated.',
    ],
    not: 'It is no proof. A search can miss a worse case, and everything holds for this model, these bounds and this criterion only. The verdict’s sentence and scope say which.',
  },
  {
    outcome: 'inconclusive',
    says: 'Neither of the two can be said. The reason stands in the sentence, and the check that does not hold is marked.',
    not: 'It does not mean nearly violated. Usual reasons: two methods disagree, a budget was too small, the step is too coarse, evaluations failed, or the sample is too small for the target.',
  },
]

const STATES: readonly Meaning[] = [
  {
    outcome: 'failed',
    says: 'The run itself could not be carried out, after up to three attempts. The reason stands on its page.',
    not: 'It says nothing about the avoidance system.',
  },
  {
    outcome: 'cancelled',
    says: 'Cancelled by a user. Completed evaluations are kept.',
    not: 'A cancelled run has no verdict.',
  },
]

const TERMS: readonly [string, ReactNode][] = [
  ['Criterion', 'What must be kept in every flight, such as a smallest separation. The margin is the value less the criterion.'],
  [
    'Finding',
    'One distinct worst case: a valley of its own among the parameters, polished, and validated. Two are one where they are close together or no barrier is between them.',
  ],
  [
    'P(violation)',
    'How likely a flight drawn from the stated distributions violates the criterion. The bound comes from an independent, declared sample, never from a search’s own points (Clopper and Pearson 1934).',
  ],
  ['Failed evaluation', 'A flight that leaves the model’s envelope or does not stay a number. It has no value, it is counted, and it bars Cleared.'],
  ['Excluded evaluation', 'A flight whose scenario cannot hold, such as one that begins inside the safety radius. Nothing can be shown of it.'],
  ['Validation', 'The same flight at half the step, with the reference integrator (DOP853), and a few hundred of its neighbours. Where a neighbour is lower, it takes the finding’s place. Stored violations and random evaluations are simulated again as well.'],
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
          A run looks for the worst flight within the bounds of what is uncertain, and says what may be claimed. No
          verdict rests on one <Link to="/help/methods">method</Link>, or on a bound alone.{' '}
          <Link to="/help/evidence">What a verdict rests on and how it was attacked</Link>
        </>
      }
      contents={contents}
    >
      {[...MEANINGS, ...STATES].map((meaning) => (
        <section key={meaning.outcome} className="card" id={meaning.outcome}>
          <div className="bd md">
            <h2>
              <VerdictBadge outcome={meaning.outcome} />
            </h2>
            <p>{meaning.says}</p>
            {meaning.takes && (
              <>
                <p className="b">It takes all of these</p>
                <ul>
                  {meaning.takes.map((take, i) => (
                    <li key={i}>{take}</li>
                  ))}
                </ul>
              </>
            )}
            <p className="sec">
              <span className="b">What it does not say:</span> {meaning.not}
            </p>
          </div>
        </section>
      ))}
      <section className="card" id="words">
        <div className="h">
          <h2>What the words mean</h2>
        </div>
        <dl className="bd terms">
          {TERMS.map(([word, text]) => (
            <div key={word}>
              <dt>{word}</dt>
              <dd>{text}</dd>
            </div>
          ))}
        </dl>
      </section>
    </HelpFrame>
  )
}
