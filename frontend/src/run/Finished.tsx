// A run that has ended: the verdict and its evidence, by sections.
import { clsx } from 'clsx'
import { useCallback, useDeferredValue, useMemo } from 'react'
import { hasScenario } from '../api/campaign'
import { resultOf } from '../api/stages'
import { SignoffsCard } from '../signoffs/SignoffsCard'
import { useCalm } from '../ui/useCalm'
import { Banner } from './verdict/Banner'
import { Columns } from './Columns'
import { Components } from './provenance/Components'
import { Convergence } from './search/Convergence'
import { calledOf, NOMINAL } from './data/chosen'
import { bestOf, finderOf, leavesGround, type RunData, stageOf } from './data/data'
import { EncounterCard } from './verdict/EncounterCard'
import { Failures } from './search/Failures'
import { FindingsCard } from './findings/FindingsCard'
import { FiveFigures } from './verdict/FiveFigures'
import { hasView } from './flight/declared'
import { Flight } from './flight/Flight'
import { overTime } from './flight/flown'
import { FrontCard } from './findings/FrontCard'
import { IndicesCard } from './parameters/IndicesCard'
import { MethodsTable } from './search/MethodsTable'
import { Minima, rowsOf } from './search/Minima'
import { MotionCard } from './flight/MotionCard'
import { NominalWorst } from './parameters/NominalWorst'
import { Provenance } from './provenance/Provenance'
import { Notes } from './header/Notes'
import { Published } from './verdict/Published'
import { SampleCard } from './sample/SampleCard'
import { type Section, SectionTabs } from '../ui/SectionTabs'
import { SensitivityCard as Sensitivity } from './parameters/SensitivityCard'
import { SeparationCard } from './flight/SeparationCard'
import { SinceCard } from './regression/SinceCard'
import { hasSpace, SpaceSection } from './space/SpaceSection'
import { StageStrip } from './search/StageStrip'
import { Untraced } from './flight/Untraced'
import { Tornado } from './parameters/Tornado'
import { casesOf } from './data/validated'
import { ValidationCard } from './verdict/ValidationCard'
import { View } from './flight/view'
import { WhatToDo } from './verdict/WhatToDo'
import { useWhatIf } from './flight/useWhatIf'
import { WhatIfCard } from './flight/WhatIfCard'
import layout from '../ui/layout.module.css'
import styles from './run.module.css'

export function Finished({ data }: { data: RunData }) {
  const { run } = data
  const { finding, chosen } = data
  const flies = hasScenario(data.campaign)
  const view = useMemo(() => new View(run.id, flies), [run.id, flies])
  const whatIf = useWhatIf(data, view)
  const other = useDeferredValue(whatIf.answer)
  // Charts with thousands of points are rendered after the main content.
  const calm = useCalm()
  const cross = useCallback((time: number) => view.steer({ time, passing: true }), [view])
  const sensitivity = resultOf(stageOf(data, 'sensitivity'), 'sensitivity')
  const searchStages = data.stages.flatMap((stage) => {
    const search = resultOf(stage, 'search')
    return search ? [{ position: stage.position, search }] : []
  })
  const searches = searchStages.map(({ search }) => search)
  const certified = resultOf(stageOf(data, 'certify'), 'certify')
  const sample = certified?.sample ?? searches.find((search) => search.sample)?.sample ?? null
  const indices = sensitivity !== null && Boolean(sensitivity.morris ?? sensitivity.sobol)
  const front = searches.some((search) => search.front?.length)
  const minima = searchStages.filter(({ search }) => search.minima.length > 0)
  const published = run.verdict ? (data.campaign.published?.length ?? 0) : 0
  const validation = resultOf(stageOf(data, 'validate'), 'validate')
  const encounter = validation?.encounter
  const failures = data.evaluations?.failures ?? []
  const space = hasSpace(data)
  const searched = run.stages.some((stage) => stage.kind === 'search' && stage.evaluations > 0)
  const methods = run.stages.filter((stage) => stage.kind === 'search').length
  // Without a validated finding the page shows the lowest evaluation, labelled as not validated.
  const lowest = data.findings.length > 0 ? null : bestOf(data)
  // A simulator is drawn if its trace states what is where.
  const drawn = hasView(data)
  const flown = flies && data.nominalTrace !== undefined
  // Two charts fit next to the separation; more need their own row.
  const few = sensitivity !== null && sensitivity.curves.length <= 2 && flown
  // Next to the flight there is room below a short table.
  const short = data.parameters.length + run.criteria.length <= 4
  const shown = flown || data.findings.length > 0 || lowest !== null
  const raised = sensitivity !== null && short && shown
  // With many parameters the minima by start need their own row.
  const many = data.parameters.length > 3
  // A finding may have a trace although the nominal case has none.
  const timed = overTime(data.nominalTrace ?? (flies ? undefined : data.findingTrace)).length > 0
  const sections: Section[] = [
    ...(drawn ? [{ id: 'flight', name: leavesGround(data) ? 'Flight' : '3D view' }] : []),
    ...(data.findings.length ? [{ id: 'findings', name: 'Findings', count: data.findings.length }] : []),
    ...(run.baseline ? [{ id: 'since', name: 'Since the baseline', count: run.summary?.regression?.cases.length }] : []),
    ...(flown ? [{ id: 'separation', name: 'Separation' }] : []),
    ...(timed ? [{ id: 'motion', name: flies ? 'Speeds and commands' : 'Trace' }] : []),
    ...(sensitivity ? [{ id: 'sensitivity', name: 'Sensitivity', count: sensitivity.curves.length }] : []),
    ...(searched ? [{ id: 'methods', name: 'Methods', count: methods }] : []),
    ...(space ? [{ id: 'space', name: 'Parameter space' }] : []),
    ...(front ? [{ id: 'front', name: 'Pareto front' }] : []),
    ...(sample ? [{ id: 'sample', name: 'Sample', count: sample.samples }] : []),
    ...(validation ? [{ id: 'validation', name: 'Validation' }] : []),
    ...(encounter ? [{ id: 'encounter', name: encounter.unseen ? 'Encounter' : 'Effect' }] : []),
    ...(failures.length ? [{ id: 'failures', name: 'Without a value', count: run.failed_evaluations + run.excluded_evaluations }] : []),
    { id: 'provenance', name: 'Provenance' },
    { id: 'signoff', name: 'Sign-off' },
    { id: 'notes', name: 'Notes' },
  ]
  return (
    <>
      <Banner data={data} />
      {run.verdict ? (
        <FiveFigures data={data} />
      ) : (
        <div style={{ marginTop: 'var(--gap)' }}>
          <StageStrip run={run} />
        </div>
      )}
      <SectionTabs sections={sections} />
      <div className={layout.grid}>
        {run.state === 'failed' && !shown && (
          <NominalWorst data={data} className={layout.c7} title="Uncertain parameters" column={null} worst={null} />
        )}
        {run.state === 'failed' && <WhatToDo run={run} className={shown ? layout.c12 : layout.c5} />}
        {drawn && <Flight data={data} view={view} whatIf={whatIf} className={layout.c8} />}
        {!flies && !drawn && <Untraced data={data} whatIf={shown ? whatIf : null} className={layout.c12} />}
        {shown && (
          <div className={drawn ? clsx(layout.stack, styles.pair, layout.c4) : clsx(raised ? styles.two : layout.stack, layout.c12)}>
            {(flown || !flies) && <WhatIfCard data={data} state={whatIf} className="" />}
            <NominalWorst
              data={data}
              className=""
              title={titleOf(data)}
              note={finding || chosen === NOMINAL ? undefined : 'not validated'}
              column={chosen === NOMINAL ? null : finding ? calledOf(chosen) : 'Lowest'}
              worst={finding ? { ...finding, method: finderOf(data, finding), atBounds: finding.at_bounds } : lowest}
            />
            {raised && <Tornado data={data} result={sensitivity} className="" />}
          </div>
        )}
        {!flies && drawn && <Untraced data={data} className={layout.c12} />}
        {data.findings.length > 0 && <FindingsCard data={data} result={validation} className={layout.c12} />}
        {run.baseline && <SinceCard data={data} className={layout.c12} />}
        {flown && (
          <SeparationCard data={data} onCross={cross} standing={view} whatIf={other} className={few || timed ? layout.c7 : layout.c12} height={few ? 280 : 370} />
        )}
        {few && <Sensitivity data={data} result={sensitivity} validation={validation} className={clsx(layout.c5, layout.wide)} height={226} />}
        {timed && (
          <div className={few || !flies ? clsx(layout.stack, styles.filled, layout.c12) : clsx(layout.stack, styles.filled, layout.c5, layout.wide)} id="motion" style={{ minHeight: few || !flies ? 220 : 380 }}>
            {calm && <MotionCard data={data} onCross={cross} standing={view} whatIf={flies ? null : other} className="" />}
          </div>
        )}
        {sensitivity && !few && (
          <Sensitivity
            data={data}
            result={sensitivity}
            validation={validation}
            className={raised ? layout.c12 : layout.c8}
            height={150}
          />
        )}
        {sensitivity && !raised && <Tornado data={data} result={sensitivity} className={clsx(layout.c4, layout.wide)} tall={data.parameters.length > 6} />}
        {sensitivity && indices && <IndicesCard data={data} result={sensitivity} className={layout.c12} />}
        {searched && <MethodsTable data={data} className={layout.c7} id="methods" />}
        {searched && <Convergence data={data} className={clsx(layout.c5, layout.wide)} height={Math.min(300, 180 + 30 * methods)} />}
        <Columns
          pieces={[
            sample && {
              height: 480,
              card: <SampleCard key="sample" data={data} sample={sample} grid={certified?.grid} className="" />,
            },
            validation && {
              height: (validation.violations ? 300 : 150) + 110 * casesOf(validation, data.findings).length,
              card: <ValidationCard key="validation" data={data} result={validation} className="" />,
            },
            encounter
              ? {
                  height: 210 + 24 * (1 + data.findings.length),
                  card: <EncounterCard key="encounter" data={data} encounter={encounter} className="" />,
                }
              : null,
            ...(many ? [] : minima).map(({ position, search }) => ({
              height: 110 + 38 * rowsOf(search),
              card: <Minima key={position} data={data} search={search} position={position} className="" />,
            })),
            // No room next to a sample: its own row is lower than two columns of different height.
            published > 0 &&
              !sample && { height: 130 + 44 * published, card: <Published key="published" data={data} className="" /> },
          ]}
        />
        {published > 0 && sample && <Published data={data} className={layout.c12} />}
        {space && <SpaceSection data={data} whatIf={shown && (flown || !flies) ? whatIf : null} />}
        {front && <FrontCard data={data} className={layout.c12} />}
        {many && minima.map(({ position, search }) => <Minima key={position} data={data} search={search} position={position} className={layout.c12} tall />)}
        {failures.length > 0 && <Failures data={data} className={layout.c12} />}
        <Provenance data={data} className={layout.c12} />
        <Components run={run} className={layout.c12} />
        <SignoffsCard run={run} className={layout.c6} />
        <Notes run={run} className={layout.c6} />
      </div>
    </>
  )
}

function titleOf({ chosen, finding }: RunData): string {
  if (chosen === NOMINAL) return 'Nominal case'
  return finding ? `Nominal against ${chosen === 'F1' ? 'worst' : chosen}` : 'Nominal and lowest evaluation'
}

