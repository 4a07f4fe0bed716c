// The sections of the page of a run that has ended, in the order of the page. Start reading at `SECTIONS`.
import { clsx } from 'clsx'
import { SignoffsCard } from '../signoffs/SignoffsCard'
import { calledOf, NOMINAL } from './data/chosen'
import { finderOf, leavesGround, type RunData } from './data/data'
import { casesOf } from './data/validated'
import { FindingsCard } from './findings/FindingsCard'
import { FrontCard } from './findings/FrontCard'
import { Flight } from './flight/Flight'
import { MotionCard } from './flight/MotionCard'
import { SeparationCard } from './flight/SeparationCard'
import { Untraced } from './flight/Untraced'
import { WhatIfCard } from './flight/WhatIfCard'
import { Notes } from './header/Notes'
import { IndicesCard } from './parameters/IndicesCard'
import { NominalWorst } from './parameters/NominalWorst'
import { SensitivityCard as Sensitivity } from './parameters/SensitivityCard'
import { Tornado } from './parameters/Tornado'
import { Components } from './provenance/Components'
import { Provenance } from './provenance/Provenance'
import { heightOf, NotReweighted, ReweightCard } from './sample/ReweightCard'
import { SampleCard } from './sample/SampleCard'
import { Convergence } from './search/Convergence'
import { Failures } from './search/Failures'
import { MethodsTable } from './search/MethodsTable'
import { Minima, rowsOf } from './search/Minima'
import { type Added, type Page, section, type Section } from './section'
import { CoverageSection } from './space/Coverage'
import { SpaceSection } from './space/SpaceSection'
import { EncounterCard } from './verdict/EncounterCard'
import { Published } from './verdict/Published'
import { ValidationCard } from './verdict/ValidationCard'
import { WhatToDo } from './verdict/WhatToDo'
import { OnceCalm } from '../ui/useCalm'
import { layout } from '../ui/styles'
import styles from './run.module.css'

/** Of stages, one file each; a new one needs no line here. */
const ADDED = Object.values(import.meta.glob<Added>('./stages/*.tsx', { eager: true, import: 'added' }))

const OWN: readonly Section[] = [
  section({
    id: 'parameters',
    of: ({ data, shown }) => data.run.state === 'failed' && !shown,
    card: ({ data }) => <NominalWorst data={data} className={layout.c7} title="Uncertain parameters" column={null} worst={null} />,
  }),
  section({
    id: 'what-to-do',
    of: ({ data }) => data.run.state === 'failed',
    card: ({ data, shown }) => <WhatToDo run={data.run} className={shown ? layout.c12 : layout.c5} />,
  }),
  section({
    id: 'flight',
    of: ({ drawn }) => drawn,
    title: ({ data }) => (leavesGround(data) ? 'Flight' : '3D view'),
    card: ({ data, view, whatIf }) => <Flight data={data} view={view} whatIf={whatIf} className={layout.c8} />,
  }),
  section({
    id: 'trace',
    of: ({ flies, drawn }) => !flies && !drawn,
    card: ({ data, shown, whatIf }) => <Untraced data={data} whatIf={shown ? whatIf : null} />,
  }),
  section({
    id: 'cases',
    of: ({ shown }) => shown,
    card: (page) => (
      <div className={page.drawn ? clsx(layout.stack, styles.pair, layout.c4) : clsx(page.raised ? styles.two : layout.stack, layout.c12)}>
        <Cases {...page} />
      </div>
    ),
  }),
  section({
    id: 'trace',
    of: ({ flies, drawn }) => !flies && drawn,
    card: ({ data }) => <Untraced data={data} />,
  }),
  section({
    id: 'findings',
    of: ({ data }) => data.findings.length > 0,
    title: 'Findings',
    count: ({ data }) => data.findings.length,
    card: ({ data, validation }) => <FindingsCard data={data} gathered={validation?.findings} />,
  }),
  section({
    id: 'separation',
    of: ({ flown }) => flown,
    title: 'Separation',
    card: ({ data, cross, view, other, few, timed, validation }) => (
      <SeparationCard
        data={data}
        onCross={cross}
        standing={view}
        mismeasured={!!validation?.encounter?.mismeasured}
        whatIf={other}
        className={few || timed ? layout.c7 : layout.c12}
        height={few ? 280 : 370}
      />
    ),
  }),
  section({
    id: 'sensitivity',
    of: ({ sensitivity, few }) => few && sensitivity,
    title: 'Sensitivity',
    count: (_, { curves }) => curves.length,
    card: ({ data, validation }, result) => (
      <Sensitivity data={data} result={result} gathered={validation?.findings} className={clsx(layout.c5, layout.wide)} height={226} />
    ),
  }),
  section({
    id: 'motion',
    of: ({ timed }) => timed,
    title: ({ flies }) => (flies ? 'Speeds and commands' : 'Trace'),
    card: ({ data, cross, view, other, flies, few }) => (
      <div className={few || !flies ? clsx(layout.stack, styles.filled, layout.c12) : clsx(layout.stack, styles.filled, layout.c5, layout.wide)} id="motion" style={{ minHeight: few || !flies ? 220 : 380 }}>
        <OnceCalm>
          <MotionCard data={data} onCross={cross} standing={view} whatIf={flies ? null : other} />
        </OnceCalm>
      </div>
    ),
  }),
  section({
    id: 'sensitivity',
    of: ({ sensitivity, few }) => !few && sensitivity,
    title: 'Sensitivity',
    count: (_, { curves }) => curves.length,
    card: ({ data, validation, raised }, result) => (
      <Sensitivity data={data} result={result} gathered={validation?.findings} className={raised ? layout.c12 : layout.c8} height={150} />
    ),
  }),
  section({
    id: 'tornado',
    of: ({ sensitivity, raised }) => !raised && sensitivity,
    card: ({ data }, result) => <Tornado data={data} result={result} className={clsx(layout.c4, layout.wide)} tall={data.parameters.length > 6} />,
  }),
  section({
    id: 'indices',
    of: ({ sensitivity }) => (sensitivity?.morris ?? sensitivity?.sobol ? sensitivity : null),
    card: ({ data }, result) => <IndicesCard data={data} result={result} />,
  }),
  section({
    id: 'methods',
    of: ({ searched }) => searched,
    title: 'Methods',
    count: ({ methods }) => methods,
    card: ({ data }) => <MethodsTable data={data} className={layout.c7} id="methods" />,
  }),
  section({
    id: 'convergence',
    of: ({ searched }) => searched,
    card: ({ data, methods }) => <Convergence data={data} className={clsx(layout.c5, layout.wide)} height={Math.min(300, 180 + 30 * methods)} />,
  }),
  section({
    id: 'sample',
    of: ({ sample }) => sample,
    title: 'Sample',
    count: (_, { samples }) => samples,
    pieces: ({ data, grid, blocks, certified }, sample) => [
      { height: 480, card: <SampleCard key="sample" data={data} sample={sample} grid={grid} blocks={blocks} /> },
      { height: certified ? heightOf(data) : 90, card: certified ? <ReweightCard key="reweight" data={data} /> : <NotReweighted key="reweight" /> },
    ],
  }),
  section({
    id: 'validation',
    of: ({ validation }) => validation,
    title: 'Validation',
    pieces: ({ data }, result) => [
      {
        height: (result.violations ? 300 : 150) + 110 * casesOf(result, data.findings).length,
        card: <ValidationCard key="validation" data={data} result={result} />,
      },
    ],
  }),
  section({
    id: 'encounter',
    of: ({ validation }) => validation?.encounter,
    title: (_, { unseen }) => (unseen ? 'Encounter' : 'Effect'),
    pieces: ({ data }, encounter) => [
      { height: 210 + 24 * (1 + data.findings.length), card: <EncounterCard key="encounter" data={data} encounter={encounter} /> },
    ],
  }),
  section({
    id: 'minima',
    of: ({ minima, many }) => !many && minima,
    pieces: ({ data }, minima) =>
      minima.map(({ position, search }) => ({
        height: 110 + 38 * rowsOf(search),
        card: <Minima key={position} data={data} search={search} position={position} />,
      })),
  }),
  section({
    id: 'published',
    // No room next to a sample: its own row is lower than two columns of different height.
    of: ({ sample, published }) => !sample && published,
    pieces: ({ data }, published) => [{ height: 130 + 44 * published, card: <Published key="published" data={data} /> }],
  }),
  section({
    id: 'published',
    of: ({ sample, published }) => sample && published,
    card: ({ data }) => <Published data={data} className={layout.c12} />,
  }),
  section({
    id: 'space',
    of: ({ space }) => space,
    title: 'Parameter space',
    card: ({ data, whatIf, shown, flown, flies }) => <SpaceSection data={data} whatIf={shown && (flown || !flies) ? whatIf : null} />,
  }),
  section({ id: 'coverage', of: ({ space }) => space, card: ({ data }) => <CoverageSection data={data} /> }),
  section({
    id: 'front',
    of: ({ front }) => front,
    title: 'Pareto front',
    card: ({ data }) => <FrontCard data={data} />,
  }),
  section({
    id: 'minima',
    of: ({ minima, many }) => many && minima,
    card: ({ data }, minima) =>
      minima.map(({ position, search }) => <Minima key={position} data={data} search={search} position={position} className={layout.c12} tall />),
  }),
  section({
    id: 'failures',
    of: ({ data }) => data.evaluations?.failures.length,
    title: 'Without a value',
    count: ({ data }) => data.run.failed_evaluations + data.run.excluded_evaluations,
    card: ({ data }) => <Failures data={data} />,
  }),
  section({
    id: 'provenance',
    of: ({ data }) => data,
    title: 'Provenance',
    card: ({ data }) => (
      <>
        <Provenance data={data} />
        <Components run={data.run} />
      </>
    ),
  }),
  section({ id: 'signoff', of: ({ data }) => data.run, title: 'Sign-off', card: (_, run) => <SignoffsCard run={run} /> }),
  section({ id: 'notes', of: ({ data }) => data.run, title: 'Notes', card: (_, run) => <Notes run={run} className={layout.c6} /> }),
]

/** The section of each file behind the last with the id that it names, or at the end if there is none. */
export const SECTIONS: readonly Section[] = OWN.flatMap((one) => [
  one,
  ...ADDED.flatMap(({ after, section }) => ((OWN.findLast(({ id }) => id === after) ?? OWN.at(-1)) === one ? section : [])),
])

/** The nominal case and the chosen one as tables, and the what-if. */
function Cases({ data, whatIf, flown, flies, lowest, raised, sensitivity }: Page) {
  const { finding, chosen } = data
  return (
    <>
      {(flown || !flies) && <WhatIfCard data={data} state={whatIf} />}
      <NominalWorst
        data={data}
        title={titleOf(data)}
        note={finding || chosen === NOMINAL ? undefined : 'not validated'}
        column={chosen === NOMINAL ? null : finding ? calledOf(data) : 'Lowest'}
        worst={finding ? { ...finding, cost: finding.granted, method: finderOf(data, finding), atBounds: finding.at_bounds } : lowest}
      />
      {raised && sensitivity && <Tornado data={data} result={sensitivity} />}
    </>
  )
}

function titleOf(data: RunData): string {
  if (data.chosen === NOMINAL) return 'Nominal case'
  return data.finding ? `Nominal against ${calledOf(data).replace('Worst', 'worst')}` : 'Nominal and lowest evaluation'
}
