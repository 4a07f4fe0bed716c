// A run that is over: the verdict and, section by section, everything it rests on.
import { lazy, Suspense, useMemo } from 'react'
import { resultOf } from '../api/results'
import { SignoffsCard } from '../signoffs/SignoffsCard'
import { Banner } from './Banner'
import { Convergence } from './Convergence'
import { calledOf, NOMINAL } from './chosen'
import { bestOf, type RunData, stageOf } from './data'
import { Failures } from './Failures'
import { FindingsCard } from './FindingsCard'
import { FiveFigures } from './FiveFigures'
import { Flight } from './Flight'
import { FrontCard } from './FrontCard'
import { IndicesCard } from './IndicesCard'
import { MethodsTable } from './MethodsTable'
import { Minima } from './Minima'
import { NominalWorst } from './NominalWorst'
import { Provenance } from './Provenance'
import { Published } from './Published'
import { SampleCard } from './SampleCard'
import { type Section, SectionTabs } from './SectionTabs'
import { SensitivityCard } from './SensitivityCard'
import { SeparationCard } from './SeparationCard'
import { StageStrip } from './StageStrip'
import { Tornado } from './Tornado'
import { ValidationCard } from './ValidationCard'
import { View } from './view'

const SpaceCard = lazy(() => import('../space/SpaceCard').then((module) => ({ default: module.SpaceCard })))

export function Finished({ data }: { data: RunData }) {
  const { run } = data
  const { finding, chosen } = data
  const view = useMemo(() => new View(run.id), [run.id])
  const sensitivity = resultOf(stageOf(data, 'sensitivity'), 'sensitivity')
  const searches = data.stages.flatMap((stage) => resultOf(stage, 'search') ?? [])
  const certified = resultOf(stageOf(data, 'certify'), 'certify')
  const sample = certified?.sample ?? searches.find((search) => search.sample)?.sample ?? null
  const indices = sensitivity !== null && Boolean(sensitivity.morris ?? sensitivity.sobol)
  const front = searches.some((search) => search.front?.length)
  const minima = searches.filter((search) => search.minima.length > 0)
  const validation = resultOf(stageOf(data, 'validate'), 'validate')
  const failures = data.evaluations?.failures ?? []
  const space = data.parameters.length > 0 && data.evaluations?.stages.some((stage) => stage.index.length > 0)
  const searched = run.stages.some((stage) => stage.kind === 'search' && stage.evaluations > 0)
  const methods = run.stages.filter((stage) => stage.kind === 'search').length
  // Without a validated finding the page shows the lowest flight, and says that it is no more than that.
  const lowest = data.findings.length > 0 ? null : bestOf(data)
  const flown = data.nominalTrace !== undefined
  // Two curves stand beside the separation, more take a row of their own.
  const few = sensitivity !== null && sensitivity.curves.length <= 2 && flown
  // Where each start ended needs a row of its own with many parameters.
  const many = data.parameters.length > 3
  const sections: Section[] = [
    ...(flown ? [{ id: 'flight', name: 'Flight' }] : []),
    ...(data.findings.length ? [{ id: 'findings', name: 'Findings', count: data.findings.length }] : []),
    ...(flown ? [{ id: 'separation', name: 'Separation' }] : []),
    ...(sensitivity ? [{ id: 'sensitivity', name: 'Sensitivity', count: sensitivity.curves.length }] : []),
    ...(searched ? [{ id: 'methods', name: 'Methods', count: methods }] : []),
    ...(space ? [{ id: 'space', name: 'Parameter space' }] : []),
    ...(front ? [{ id: 'front', name: 'Front' }] : []),
    ...(sample ? [{ id: 'sample', name: 'Sample', count: sample.samples }] : []),
    ...(validation ? [{ id: 'validation', name: 'Validation' }] : []),
    ...(failures.length ? [{ id: 'failures', name: 'Failed evaluations', count: failures.length }] : []),
    { id: 'provenance', name: 'Provenance' },
    { id: 'signoff', name: 'Sign-off' },
    { id: 'notes', name: 'Notes' },
  ]
  return (
    <>
      <Banner run={run} />
      {run.verdict ? (
        <FiveFigures data={data} />
      ) : (
        <div style={{ marginTop: 'var(--gap)' }}>
          <StageStrip run={run} />
        </div>
      )}
      <SectionTabs sections={sections} />
      <div className="grid">
        {flown && <Flight data={data} view={view} className="c8" />}
        {(flown || data.findings.length > 0 || lowest) && (
          <div className={flown ? 'stack pair c4' : 'stack pair c6'}>
            <NominalWorst
              data={data}
              className=""
              title={titleOf(data)}
              column={chosen === NOMINAL ? null : finding ? calledOf(chosen) : 'Lowest, not validated'}
              worst={finding ? { ...finding, method: methodOf(data), atBounds: finding.at_bounds } : lowest}
            />
            {few && <Tornado data={data} result={sensitivity} className="" />}
          </div>
        )}
        {data.findings.length > 0 && <FindingsCard data={data} result={validation} className="c12" />}
        {flown && <SeparationCard data={data} onCross={(time) => view.steer({ time })} className={few ? 'c7' : 'c12'} />}
        {sensitivity && (
          <SensitivityCard data={data} result={sensitivity} className={few ? 'c5' : 'c8'} height={few ? 226 : 150} />
        )}
        {sensitivity && !few && <Tornado data={data} result={sensitivity} className="c4" />}
        {sensitivity && indices && <IndicesCard data={data} result={sensitivity} className="c12" />}
        <div className="stack c7 wide">
          {searched && <MethodsTable data={data} className="" id="methods" />}
          {!many && minima.map((search) => <Minima key={search.method} data={data} search={search} className="" />)}
          {validation && <ValidationCard data={data} result={validation} className="" />}
          {run.verdict && <Published data={data} className="" />}
        </div>
        <div className="stack c5 wide">
          {searched && <Convergence data={data} className="" />}
          {sample && <SampleCard data={data} sample={sample} grid={certified?.grid} className="" />}
        </div>
        {space && (
          // Loaded after the page; the height is kept for it, so that what follows does not jump.
          <div className="c12" id="space" style={{ minHeight: 520 }}>
            <Suspense>
              <SpaceCard data={data} className="" />
            </Suspense>
          </div>
        )}
        {front && <FrontCard data={data} className="c12" />}
        {many && minima.map((search) => <Minima key={search.method} data={data} search={search} className="c12" tall />)}
        {failures.length > 0 && <Failures data={data} className="c12" />}
        <Provenance data={data} className="c12" />
        <SignoffsCard run={run} className="c12" />
      </div>
    </>
  )
}

function titleOf({ chosen, finding }: RunData): string {
  if (chosen === NOMINAL) return 'Nominal flight'
  return finding ? `Nominal against ${chosen === 'F1' ? 'worst' : chosen}` : 'Nominal and lowest flown'
}

/** Who came to the chosen finding with the least work; of the worst one, who found it lowest. */
function methodOf({ run, chosen, finding }: RunData): string | null {
  if (chosen === 'F1') return run.worst_method
  const found = [...(finding?.found ?? [])].sort((a, b) => a.evaluations - b.evaluations)
  return found[0]?.method ?? null
}
