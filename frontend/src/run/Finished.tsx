// A run that has ended: the verdict and its evidence, by sections.
import { useCallback, useDeferredValue, useMemo } from 'react'
import { SectionTabs } from '../ui/SectionTabs'
import type { RunData } from './data/data'
import { factsOf } from './facts'
import { useWhatIf } from './flight/useWhatIf'
import { View } from './flight/view'
import { StageStrip } from './search/StageStrip'
import { type Page, Sections } from './section'
import { SECTIONS } from './sections'
import { Banner } from './verdict/Banner'
import { FiveFigures } from './verdict/FiveFigures'

export function Finished({ data }: { data: RunData }) {
  const { run } = data
  const facts = factsOf(data)
  const view = useMemo(() => new View(run.id, facts.flies), [run.id, facts.flies])
  const whatIf = useWhatIf(data, view)
  const other = useDeferredValue(whatIf.answer)
  const cross = useCallback((time: number) => view.steer({ time, passing: true }), [view])
  const page: Page = { ...facts, data, view, whatIf, other, cross }
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
      <SectionTabs sections={SECTIONS.flatMap((one) => one.tab(page) ?? [])} />
      <Sections sections={SECTIONS} page={page} />
    </>
  )
}
