// A scenario seen from above: start with heading, goal or course, obstacles with the required distance, and its stored
// nominal flight, whose moving obstacles are where they are at the closest approach. Without a flight it is drawn from
// the document alone. The geometry is in plan.ts.
import { memo } from 'react'
import type { Campaign } from '../../api/campaign'
import type { Catalogue, DrawnFlight } from '../../client'
import { type Nominal, nominalOf } from './nominal'
import { describedBy, extentOf, fit, type PlanBody, planOf, reachOf, type Window } from './plan'
import { Goal, Head, line, Obstacle, Start } from './scene'
import { useWidth } from '../../ui/useWidth'

interface PlanViewProps {
  campaign: Campaign
  catalogue: Catalogue | undefined
  flight?: DrawnFlight | null
  /** Whether the flight keeps the required distance. */
  clear?: boolean
  height?: number
}

/** Until the width of its place is known [px]. */
const FIRST = 280

export const PlanView = memo(function PlanView({ campaign, catalogue, flight, clear = true, height = 140 }: PlanViewProps) {
  const plan = planOf(campaign, catalogue)
  const reach = reachOf(campaign, catalogue)
  const nominal = flight ? nominalOf(flight, plan.axes) : null
  const [holder, width] = useWidth(FIRST)
  const bodies = plan.bodies.map((body, i) => placed(body, i, nominal))
  const flown = nominal ? [...nominal.path, ...[...nominal.tracks.values()].flat()] : []
  // A course beyond the end of its flight is not drawn.
  const shown = { ...plan, bodies, way: nominal && !plan.goal ? [] : plan.way }
  const view = fit([...extentOf(shown, reach), ...flown], width, height, { x: 24, y: 18 })
  const { goal } = plan
  return (
    <div ref={holder} style={{ overflow: 'hidden' }}>
      <svg
        viewBox={`0 0 ${width} ${height}`}
        width={width}
        height={height}
        style={{ display: 'block' }}
        role="img"
        aria-label={`${nominal ? 'Nominal case' : 'Plan'} of ${campaign.name} from above: ${describedBy(plan)}`}
      >
        <Grid view={view} width={width} height={height} />
        <path
          d={line(shown.way, view)}
          fill="none"
          stroke="var(--c-nom)"
          strokeDasharray={goal ? '2 4' : undefined}
          strokeWidth={1.3}
          opacity={nominal ? 0.6 : 1}
        />
        {!goal && <Head way={shown.way} pixels={view} colour="var(--c-nom)" />}
        {bodies.map((body, i) => (
          <Body key={i} body={body} reach={reach} surface={plan.surface} view={view} />
        ))}
        {nominal && <Flown nominal={nominal} clear={clear} view={view} />}
        <Start plan={plan} pixels={view} size={0.1 * height} />
        {goal && <Goal at={goal} pixels={view} />}
      </svg>
    </div>
  )
})

/** An obstacle on its simulated path, where it is at the closest approach. */
function placed(body: PlanBody, i: number, nominal: Nominal | null): PlanBody {
  const [at, track] = [nominal?.moment.get(i), nominal?.tracks.get(i)]
  return at && track ? { ...body, at: { ...body.at, ...at }, track: track.map((p) => ({ up: 0, t: 0, ...p })) } : body
}

/** The path, its end, and the distance at the closest approach. */
function Flown({ nominal, clear, view }: { nominal: Nominal; clear: boolean; view: Window }) {
  const { path, closest } = nominal
  const end = path.at(-1)
  const colour = clear ? 'var(--ink)' : 'var(--c-worst)'
  return (
    <g>
      <path d={line(path, view)} fill="none" stroke="var(--c-nom)" strokeWidth={2} strokeLinejoin="round" />
      {end && <circle cx={view.x(end)} cy={view.y(end)} r={2.4} fill="var(--c-nom)" />}
      {closest && (
        <>
          <path d={line([closest.at, closest.other], view)} stroke={colour} strokeWidth={1.4} />
          <circle cx={view.x(closest.at)} cy={view.y(closest.at)} r={2.8} fill={colour} />
        </>
      )}
    </g>
  )
}

/** An obstacle with the required distance; a moving one with its path and direction. */
function Body({ body, reach, surface, view }: { body: PlanBody; reach: number; surface: boolean; view: Window }) {
  const { track } = body
  return (
    <g>
      {track.length > 1 && (
        <>
          <path d={line(track, view)} fill="none" stroke="var(--c-obs)" strokeWidth={1.6} strokeDasharray="5 4" />
          <Head way={track} pixels={view} colour="var(--c-obs)" />
        </>
      )}
      <Obstacle body={body} reach={reach} surface={surface} pixels={view} scale={view.scale} />
    </g>
  )
}

/** Grid lines at a round spacing. */
function Grid({ view, width, height }: { view: Window; width: number; height: number }) {
  const raw = 36 / view.scale
  const power = 10 ** Math.floor(Math.log10(raw))
  const step = ([1, 2, 5, 10].find((m) => m * power >= raw) ?? 10) * power * view.scale
  const [ox, oy] = [view.x({ x: 0, y: 0 }), view.y({ x: 0, y: 0 })]
  const first = (origin: number) => ((origin % step) + step) % step
  const lines: string[] = []
  for (let x = first(ox); x <= width; x += step) lines.push(`M${x} 0V${height}`)
  for (let y = first(oy); y <= height; y += step) lines.push(`M0 ${y}H${width}`)
  return <path d={lines.join('')} stroke="var(--vp-line)" strokeWidth={0.7} fill="none" />
}
