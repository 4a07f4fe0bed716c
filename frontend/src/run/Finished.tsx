// A run that is over: the verdict and, section by section, everything it rests on.
import { useRef } from 'react'
import { resultOf } from '../api/results'
import { Banner } from './Banner'
import { Convergence } from './Convergence'
import { type RunData, stageOf } from './data'
import { Failures } from './Failures'
import { FiveFigures } from './FiveFigures'
import { Flight } from './Flight'
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

export function Finished({ data }: { data: RunData }) {
  const { run } = data
  const grid = useRef<HTMLDivElement>(null)
  const finding = data.findings[0]
  const sensitivity = resultOf(stageOf(data, 'sensitivity'), 'sensitivity')
  const searches = data.stages.flatMap((stage) => resultOf(stage, 'search') ?? [])
  const sample = searches.find((search) => search.sample)?.sample ?? null
  const minima = searches.filter((search) => search.minima.length > 0)
  const validation = resultOf(stageOf(data, 'validate'), 'validate')
  const failures = data.evaluations?.failures ?? []
  const begun = run.stages.some((stage) => stage.evaluations > 0)
  const flown = data.nominalTrace !== undefined
  const sections: Section[] = [
    ...(flown
      ? [
          { id: 'flight', name: 'Flight' },
          { id: 'separation', name: 'Separation' },
        ]
      : []),
    ...(sensitivity ? [{ id: 'sensitivity', name: 'Sensitivity', count: sensitivity.curves.length }] : []),
    ...(searches.length ? [{ id: 'methods', name: 'Methods', count: searches.length }] : []),
    ...(sample ? [{ id: 'sample', name: 'Sample', count: sample.samples }] : []),
    ...(validation ? [{ id: 'validation', name: 'Validation' }] : []),
    ...(failures.length ? [{ id: 'failures', name: 'Failed evaluations', count: failures.length }] : []),
    { id: 'provenance', name: 'Provenance' },
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
      <div className="grid" ref={grid}>
        {flown && <Flight data={data} className="c8" />}
        {(flown || finding) && (
          <NominalWorst
            data={data}
            className="c4"
            title="Nominal against worst"
            column="Worst"
            worst={
              finding
                ? {
                    cost: finding.cost,
                    parameters: finding.parameters,
                    method: run.worst_method,
                    atBounds: finding.at_bounds,
                  }
                : null
            }
          />
        )}
        {flown && <SeparationCard data={data} className="c12" />}
        {sensitivity && <SensitivityCard data={data} result={sensitivity} className="c8" />}
        {sensitivity && <Tornado data={data} result={sensitivity} className="c4" />}
        {searches.length > 0 && <MethodsTable data={data} className="c7" id="methods" />}
        {begun && searches.length > 0 && <Convergence data={data} className="c5" />}
        {minima.map((search) => (
          <Minima key={search.method} data={data} search={search} className="c7" />
        ))}
        {sample && <SampleCard data={data} sample={sample} className="c5" />}
        {validation && <ValidationCard data={data} result={validation} className="c7" />}
        <Published data={data} className="c5" />
        {failures.length > 0 && <Failures data={data} className="c12" />}
        <Provenance data={data} className="c12" />
      </div>
    </>
  )
}
