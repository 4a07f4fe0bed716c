// Compares two to four runs: differences of their campaigns and results. The runs are in the address.
import { useNavigate, useSearch } from '@tanstack/react-router'
import { useMemo } from 'react'
import { Loading } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { CopyButton } from '../ui/files'
import { Change } from './Change'
import { Code } from './Code'
import { Definition } from './Definition'
import { type Comparison, useCompared } from './data'
import { differences } from './differences'
import { FindingMargins } from './FindingMargins'
import { Methods } from './Methods'
import { ConvergenceOverlay, SeparationOverlay } from './Overlays'
import { Picks } from './Picks'
import { Ranges } from './Ranges'
import { Results } from './Results'
import { Samples } from './Samples'
import { idsOf, MOST } from './search'
import { Tracks } from './Tracks'
import { WorstParameters } from './WorstParameters'

export function ComparePage() {
  const { runs, all = false } = useSearch({ from: '/compare' })
  const navigate = useNavigate({ from: '/compare' })
  const ids = useMemo(() => idsOf(runs), [runs])
  useTitle(ids.length > 0 ? `Compare ${ids.join(', ')}` : 'Compare')
  const comparison = useCompared(ids)
  const go = (chosen: string[], everything: boolean) =>
    void navigate({
      search: { runs: chosen.join(',') || undefined, all: everything || undefined },
      replace: true,
      resetScroll: false,
    })
  return (
    <>
      <div className="ph">
        <div className="t">
          <h1>Compare runs</h1>
        </div>
        <div className="acts">
          {ids.length > 1 && (
            <CopyButton text={() => location.href}>Copy link</CopyButton>
          )}
        </div>
      </div>
      <Picks comparison={comparison} ids={ids} onChange={(chosen) => go(chosen, all)} />
      {comparison.loading && <Loading what="the runs" />}
      {!comparison.loading && comparison.runs.length < 2 && (
        <p className="sec">
          Choose two to {MOST} runs here, or mark them in the list of runs. A is drawn solid, the others dashed.
        </p>
      )}
      {comparison.runs.length > 1 && (
        <Compared comparison={comparison} all={all} onAll={(everything) => go(ids, everything)} />
      )}
    </>
  )
}

interface ComparedProps {
  comparison: Comparison
  all: boolean
  onAll: (all: boolean) => void
}

function Compared({ comparison, all, onAll }: ComparedProps) {
  const { runs } = comparison
  const rows = differences(runs)
  return (
    <>
      <Change runs={runs} />
      <div className="grid" style={{ marginTop: 'var(--gap)' }}>
        <div className="stack c5 wide">
          <Results runs={runs} className="" />
          <FindingMargins runs={runs} className="" />
        </div>
        <div className="stack c7 wide">
          <Definition runs={runs} rows={rows} all={all} onAll={onAll} className="" />
          <WorstParameters runs={runs} className="" />
        </div>
        <SeparationOverlay runs={runs} className="c7" />
        <Tracks runs={runs} className="c5" />
        <ConvergenceOverlay runs={runs} className="c7" />
        <Samples runs={runs} className="c5" />
        <div className="stack c7 wide">
          <Methods runs={runs} className="" />
          <Code runs={runs} className="" />
        </div>
        <div className="stack c5 wide">
          <Ranges runs={runs} className="" />
        </div>
      </div>
    </>
  )
}
