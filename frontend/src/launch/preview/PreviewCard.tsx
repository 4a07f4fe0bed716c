// The edited scenario in plan and side view, and its nominal flight on request, with the numbers as text.
import { IconAlertTriangle, IconCircleCheck, IconCircleX, IconLoader, IconRoute } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { useMemo } from 'react'
import type { Campaign } from '../../api/campaign'
import type { Catalogue, ComponentEntry, Preview } from '../../client'
import { decimalsApart, duration, exact, fixed, plain } from '../../format/numbers'
import { unitText } from '../../format/units'
import { Button, TextButton } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { Sign } from '../../ui/Sign'
import { useWidth } from '../../ui/useWidth'
import { flownOf } from './flown'
import { describedBy, planOf, reachOf } from '../plan/plan'
import { Key, Legend } from '../plan/scene'
import { PreviewPlan } from './PreviewPlan'
import { hasHeights, PreviewSide } from './PreviewSide'
import { rangesOf } from './ranges'
import type { LivePreview } from './usePreview'
import { icons, layout } from '../../ui/styles'
import styles from './preview.module.css'

/** A simulation that takes longer is probably being compiled [s]. */
const LONG = 3

interface PreviewCardProps {
  campaign: Campaign
  catalogue: Catalogue
  criterion: ComponentEntry | undefined
  /** Whether the text can be parsed as a campaign, and has no problems. */
  readable: boolean
  ok: boolean
  live: LivePreview
}

const FROM = { '': '', none: '', centre: ' from centres', surface: ' from surfaces' }

export function PreviewCard({ campaign, catalogue, criterion, readable, ok, live }: PreviewCardProps) {
  const [holder, width] = useWidth(300)
  const drawn = useMemo(() => {
    const plan = planOf(campaign, catalogue)
    return { plan, ranges: rangesOf(campaign, catalogue, plan) }
  }, [campaign, catalogue])
  const flown = useMemo(() => (live.flown ? flownOf(live.flown) : null), [live.flown])
  const reach = reachOf(campaign, catalogue)
  const shared = { ...drawn, reach, flown, stale: live.stale, width }
  const bodies = drawn.plan.bodies
  const label = `${campaign.name}: ${describedBy(drawn.plan)}`
  const ranges = drawn.ranges.boxes.length + drawn.ranges.fans.length + drawn.ranges.rings.length
  return (
    <Card title="Preview" className={styles.preview} note={readable ? undefined : 'of the last text that could be read'}>
      <div ref={holder}>
        <PreviewPlan {...shared} label={`Seen from above, ${label}`} />
        {hasHeights(shared) && <PreviewSide {...shared} label={`Seen from the side, ${label}`} />}
        <Legend>
          {flown && <Key colour="--c-nom">Nominal path</Key>}
          {bodies.some((body) => body.moving) && <Key colour="--c-obs" dash="5 3">{flown ? 'Path of the obstacle' : 'Intended path'}</Key>}
          {reach > 0 && <Key colour="--c-crit" dash="3 2">Distance {plain(reach)} m{FROM[criterion?.measured_to ?? 'none']}</Key>}
          {ranges > 0 && (
            <span>
              <i className={styles.swatch} aria-hidden /> Uncertain
            </span>
          )}
        </Legend>
        <Flight ok={ok} live={live} criterion={criterion} />
      </div>
    </Card>
  )
}

function Flight({ ok, live, criterion }: { ok: boolean; live: LivePreview; criterion: ComponentEntry | undefined }) {
  const { following, flown, stale, waited, trouble } = live
  return (
    <div style={{ marginTop: 10 }}>
      <Button wide icon={IconRoute} aria-pressed={following} onClick={() => live.follow(!following)}>
        {following ? 'Stop previewing every edit' : 'Preview nominal case'}
      </Button>
      <div className={clsx(styles.statement, 'small')} aria-live="polite" data-testid="nominal-flight">
        {following && !ok && <p className="mut">It is simulated again after the problems are solved.</p>}
        {waited !== null && (
          <p className={layout.row}>
            <IconLoader className={clsx(icons.spin, 'i s')} aria-hidden />
            <span>
              Simulating the nominal case{waited > 0 && `, ${waited} s`}.
              {waited >= LONG && ' New combinations of components are compiled first: once, for up to a minute.'}
            </span>
          </p>
        )}
        {following && trouble && (
          <p className={clsx(layout.row, 'bad-t')}>
            <IconAlertTriangle className="i s" aria-hidden />
            <span>
              {trouble.message}{' '}
              <TextButton onClick={live.again}>Try again</TextButton>
            </span>
          </p>
        )}
        {flown && <FlightNumbers flown={flown} stale={stale} criterion={criterion} />}
      </div>
    </div>
  )
}

function FlightNumbers({ flown, stale, criterion }: { flown: Preview; stale: boolean; criterion: ComponentEntry | undefined }) {
  const { value, margin, threshold, closest, realisation } = flown
  const decimals = decimalsApart([value, threshold])
  const unit = unitText(flown.unit)
  const sign = <Sign text={flown.quantity || criterion?.quantity || 'value'} />
  return (
    <div className={stale ? 'mut' : undefined}>
      {stale && <p>Of the campaign before the last edit:</p>}
      {value === null || margin === null ? (
        <p className={layout.row}>
          <IconAlertTriangle className="i s" aria-hidden />
          <span>
            The nominal case is {flown.status}: {flown.reason || 'the reason is unknown'}.
          </span>
        </p>
      ) : (
        <p className={margin > 0 ? layout.row : clsx(layout.row, 'bad-t')}>
          {margin > 0 ? <IconCircleCheck className="i s" aria-hidden /> : <IconCircleX className="i s" aria-hidden />}
          <span>
            Nominal {sign}{' '}
            <b className="num">
              {fixed(value, decimals)} {unit}
            </b>
            ,{' '}
            {margin > 0
              ? `clear by ${fixed(margin, decimals)} ${unit}`
              : `violates ${exact(threshold)} ${unit} by ${fixed(-margin, decimals)} ${unit}`}
            {closest && `, closest after ${fixed(closest.time, 2)} s`}
          </span>
        </p>
      )}
      {realisation && realisation.seeds > 1 && (
        <p className="mut">
          {realisation.combine === 'worst' ? 'The worst' : 'The average'} of {realisation.seeds} realisations; drawn is seed {realisation.seed}.
        </p>
      )}
      <p className="mut">One simulation at nominal values, not stored; it took {duration(flown.seconds)}.</p>
    </div>
  )
}
