// Compares two to four runs: differences of their campaigns and results. The runs are in the address.
import { clsx } from 'clsx'
import { IconAlertTriangle, IconArrowsExchange, IconGitCompare } from '@tabler/icons-react'
import { useNavigate, useSearch } from '@tanstack/react-router'
import { type ReactNode, useMemo } from 'react'
import { PageHead } from '../page/PageHead'
import { Loading } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { CopyButton } from '../ui/files'
import { Change } from './Change'
import { Code } from './Code'
import { Definition } from './Definition'
import { type Comparison, unitOf, useCompared } from './data'
import { differences } from './differences'
import { FindingMargins } from './FindingMargins'
import { bestsIn, Methods } from './Methods'
import { ConvergenceOverlay, searchesIn, SeparationOverlay } from './Overlays'
import { Picks } from './Picks'
import { Ranges, rangesIn } from './Ranges'
import { Results } from './Results'
import { Samples, samplesIn } from './Samples'
import { idsOf, MOST } from './search'
import { Tracks } from './Tracks'
import { WorstParameters } from './WorstParameters'
import { Button, ButtonLink } from '../ui/Button'
import { cards, layout } from '../ui/styles'

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
      <PageHead title="Compare runs">
        {ids.length > 1 && (
          <>
            <Button small icon={IconArrowsExchange} onClick={() => go(ids.toReversed(), all)} title="The last run becomes A">
              {ids.length === 2 ? 'Swap' : 'Reverse the order'}
            </Button>
            <CopyButton text={() => location.href}>Copy link</CopyButton>
          </>
        )}
      </PageHead>
      <Picks comparison={comparison} ids={ids} onChange={(chosen) => go(chosen, all)} />
      {comparison.loading && <Loading what="the runs" />}
      <Failed comparison={comparison} />
      {!comparison.loading && comparison.missing.length === 0 && comparison.runs.length < 2 && (
        <div className={clsx(cards.card, layout.centre)}>
          <IconGitCompare size={36} stroke={1.5} aria-hidden />
          <h2>{ids.length === 0 ? 'No runs chosen yet' : 'One more run is needed'}</h2>
          <p>
            Choose 2 to {MOST} runs here, or mark them in the list of runs and press “Compare”. A is drawn solid, the others
            dashed.
          </p>
          <div className={layout.acts}>
            <ButtonLink to="/runs">List of runs</ButtonLink>
          </div>
        </div>
      )}
      {comparison.runs.length > 1 && (
        <Compared comparison={comparison} all={all} onAll={(everything) => go(ids, everything)} />
      )}
    </>
  )
}

/** That something could not be loaded, so that what is shown is not taken for all. */
function Failed({ comparison: { missing, failed, retry } }: { comparison: Comparison }) {
  if (missing.length === 0 && !failed) return null
  return (
    <section className={clsx(cards.note, cards.warn)} role="alert" aria-label="What could not be loaded">
      <IconAlertTriangle className="i" aria-hidden />
      <p className={layout.wrapAny}>
        {missing.length > 0
          ? `${missing.map(({ id }) => id).join(', ')} could not be loaded and ${missing.length === 1 ? 'is' : 'are'} not compared.`
          : `Some results could not be loaded and are missing below: ${failed?.message ?? ''}`}{' '}
        <Button small onClick={retry}>Try again</Button>
      </p>
    </section>
  )
}

function Compared({ comparison, all, onAll }: { comparison: Comparison; all: boolean; onAll: (all: boolean) => void }) {
  const { runs } = comparison
  const rows = differences(runs)
  const unit = unitOf(runs)
  // What no run has is omitted.
  const flown = runs.some(({ nominal, worst }) => nominal ?? worst)
  const found = runs.some(({ findings }) => findings.length > 0)
  return (
    <>
      <Change runs={runs} />
      <div className={layout.grid} style={{ marginTop: 'var(--gap)' }}>
        <div className={clsx(layout.stack, layout.c5, layout.wide)}>
          <Results runs={runs} />
        </div>
        <div className={clsx(layout.stack, layout.c7, layout.wide)}>
          <Definition runs={runs} rows={rows} all={all} onAll={onAll} />
          {found && <WorstParameters runs={runs} />}
          {found && <FindingMargins runs={runs} />}
        </div>
        <Pair
          pieces={[
            flown && ((className) => <SeparationOverlay runs={runs} className={className} />),
            flown && ((className) => <Tracks runs={runs} className={className} />),
          ]}
        />
        <Pair
          pieces={[
            searchesIn(runs).length > 0 && ((className) => <ConvergenceOverlay runs={runs} className={className} />),
            samplesIn(runs).length > 0 && ((className) => <Samples runs={runs} className={className} />),
          ]}
        />
        <Pair
          pieces={[
            unit !== null && bestsIn(runs) > 0 && ((className) => <Methods runs={runs} className={className} />),
            unit !== null && rangesIn(runs) > 0 && ((className) => <Ranges runs={runs} className={className} />),
          ]}
        />
        <Code runs={runs} />
      </div>
    </>
  )
}

type Piece = false | ((className: string | undefined) => ReactNode)

/** A wide and a narrower card next to each other; one of them alone takes the whole width. */
function Pair({ pieces: [left, right] }: { pieces: [Piece, Piece] }) {
  return (
    <>
      {left && left(right ? layout.c7 : layout.c12)}
      {right && right(left ? clsx(layout.c5, layout.wide) : layout.c12)}
    </>
  )
}
