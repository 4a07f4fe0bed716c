// The basis of a verdict: attacks and countermeasures, permitted statements of a campaign, and remaining limits.
import { Link } from '@tanstack/react-router'
import { CHECKS, LIMITS } from '../api/rules'
import { useTitle } from '../page/useTitle'
import { count, percent, plain } from '../format/numbers'
import { type Column, Table } from '../ui/Table'
import { ATTACKS } from './attacks'
import { HelpFrame, Passage, Terms } from './HelpFrame'
import { missed, SAMPLES, SLITS } from './missed'
import { layout } from '../ui/styles'

const CAPS: readonly [string, string][] = [
  [
    'agreement',
    `At most ${LIMITS.agreement_at_most} of nominal minus worst counts as agreement, whatever the campaign asks for. Default ${LIMITS.agreement}.`,
  ],
  ['confidence', `At least ${LIMITS.confidence_at_least}; a campaign with less is refused. Default ${LIMITS.confidence}.`],
  [
    'target_probability',
    `The bound on P(violation) from a sample must be at most ${percent(LIMITS.ceiling)}; a target can only be stricter.`,
  ],
  ['Excluded', `At most ${percent(LIMITS.excluded)} of the draws of the sample, and of all evaluations.`],
  [
    'Least budget',
    `${LIMITS.global_least} evaluations for each uncertain parameter for a global method, ${LIMITS.local_least} for a local one.`,
  ],
]

const EXAMPLE = `encounter:
  intended:
    avoidance: The baseline run; the same scenario with the avoider is R-0007.`

export function EvidencePage() {
  useTitle('What a verdict rests on')
  const contents = [
    { title: 'Attacks', entries: ATTACKS.map(({ id, title }) => ({ id, name: title })) },
    {
      title: 'Rules and limits',
      entries: [
        { id: 'intended', name: 'What a campaign may state' },
        { id: 'caps', name: 'What a campaign cannot relax' },
        { id: 'limits', name: 'Known limits' },
      ],
    },
  ]
  return (
    <HelpFrame
      title="What a verdict rests on and how it was attacked"
      lede={
        <>
          A <Link to="/help">verdict</Link> is only as good as the attempts to make it claim too much. These are the
          classes of attack against which the checks were tested, and the countermeasures.
        </>
      }
      contents={contents}
    >
      {ATTACKS.map(({ id, title, danger, answer }) => (
        <Passage key={id} id={id} title={title}>
          <p className="sec">{danger}</p>
          <p>{answer}</p>
        </Passage>
      ))}
      <Sureness />
      <Intended />
      <Caps />
      <Limits />
    </HelpFrame>
  )
}

function Sureness() {
  return (
    <Passage id="sureness" title="How sure a search is">
      <p>
        Next to the verdict of a run that was searched by Auto alone is the chance that another search, with another
        seed and the same budget, finds a case lower by more than {percent(LIMITS.same_cost)} of nominal minus worst. It is an estimate from
        searches on random landscapes, of as many parameters as the sentence states, not a bound, and no verdict rests on it: it only counts how many evaluations are
        as low as the lowest. It does not cover a case that this kind of search cannot find, such as a needle in a
        wide valley. There is no number where it was not set, such as of a simulator that runs in slots. The guide{' '}
        <em>Methods</em> states how often such statements came true, and where they are wrong.
      </p>
    </Passage>
  )
}

function Intended() {
  return (
    <Passage id="intended" title="What a campaign may state">
      <p>
        Some campaigns are meant to have no encounter: a baseline without avoidance, a parameter that should not matter.
        The author states it in the campaign as <code>encounter.intended</code>, with the reason. The check then holds,
        and the verdict repeats the reason. No statement waives a violation, also not one beyond the horizon.
      </p>
      <pre tabIndex={0}>{EXAMPLE}</pre>
      <Terms of={CHECKS.filter(({ intended }) => intended).map(({ code, intended }) => ({ word: code.replace(' ', '_'), mono: true, text: intended }))} />
    </Passage>
  )
}

function Caps() {
  return (
    <Passage id="caps" title="What a campaign cannot relax">
      <Terms of={CAPS.map(([word, text]) => ({ word, text, mono: /^[a-z]/.test(word) }))} />
    </Passage>
  )
}

const MISSED: readonly Column<number>[] = [
  { head: 'Probability p of the set', tone: 'tn', cell: (p) => plain(p) },
  ...SAMPLES.map((n) => ({ head: `n = ${count(n)}`, num: true, cell: (p: number) => percent(missed(p, n)) })),
]

function Limits() {
  return (
    <Passage id="limits" title="Known limits">
      <p>
        <b>A narrow slit.</b> Violations in a set of probability p are missed by all of n independent samples with
        probability (1 − p)<sup>n</sup>. A search can miss such a set, too: nothing around it points to it.
      </p>
      <div className={layout.scrollx} tabIndex={0} role="region" aria-label="Table of probabilities">
        <Table tight name="Probability that a sample misses a set of violations" rows={SLITS} by={(p) => p} columns={MISSED} />
      </div>
      <p>
        <b>The model.</b> Every statement is about the model: its components, its bounds, its distributions, its
        horizon. It does not compare the model with the vehicle.
      </p>
      <p>
        <b>Failed evaluations.</b> Their outcome is unknown. They rule out Cleared, and the run list, the
        run page, the report and the command line say how many there are.
      </p>
    </Passage>
  )
}
