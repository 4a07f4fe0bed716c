// A scenario seen from above, from its document alone: start with heading, goal or course, obstacles and the paths of
// moving ones. Nothing is simulated. The geometry is in plan.ts.
import type { Campaign } from '../../api/campaign'
import type { Catalogue } from '../../client'
import { Free } from './Free'
import { extentOf, fit, type Place, type PlanBody, planOf, reachOf, type Window } from './plan'
import { useWidth } from '../../ui/useWidth'
import { degrees } from './ways'

interface PlanViewProps {
  campaign: Campaign
  catalogue: Catalogue | undefined
  height?: number
}

/** Until the width of its place is known [px]. */
const FIRST = 280

export function PlanView({ campaign, catalogue, height = 140 }: PlanViewProps) {
  const plan = planOf(campaign, catalogue)
  const reach = reachOf(campaign)
  const [holder, width] = useWidth(FIRST)
  const view = fit(extentOf(plan, reach), width, height, { x: 24, y: 18 })
  const moving = plan.bodies.filter((body) => body.track.length > 1).length
  const { start, goal } = plan
  const length = 0.1 * height
  return (
    <div ref={holder} style={{ overflow: 'hidden' }}>
      <svg
        viewBox={`0 0 ${width} ${height}`}
        width={width}
        height={height}
        style={{ display: 'block' }}
        role="img"
        aria-label={`Plan of ${campaign.name}: start, ${goal ? 'goal' : 'course'} and ${plan.bodies.length} obstacles, ${moving} of them moving`}
      >
        <Grid view={view} width={width} height={height} />
        <path
          d={line(plan.way, view)}
          fill="none"
          stroke="var(--c-nom)"
          strokeDasharray={goal ? '2 4' : undefined}
          strokeWidth={1.3}
        />
        {!goal && <Head way={plan.way} view={view} colour="var(--c-nom)" />}
        {plan.bodies.map((body, i) => (
          <Body key={i} body={body} reach={reach} surface={plan.surface} view={view} />
        ))}
        <g transform={`translate(${view.x(start)} ${view.y(start)}) rotate(${degrees(-plan.heading)})`}>
          <path
            d={`M${length} 0 L${-0.6 * length} ${0.55 * length} L${-0.3 * length} 0 L${-0.6 * length} ${-0.55 * length}Z`}
            fill="var(--ink-2)"
          />
        </g>
        {goal && (
          <>
            <path
              d={`M${view.x(goal) - 5} ${view.y(goal)}h10M${view.x(goal)} ${view.y(goal) - 5}v10`}
              stroke="var(--ink)"
              strokeWidth={1.8}
            />
            <circle cx={view.x(goal)} cy={view.y(goal)} r={7.5} fill="none" stroke="var(--ink)" strokeWidth={1.3} />
          </>
        )}
      </svg>
    </div>
  )
}

/** An obstacle with its safety radius at the start; a moving one with its path and direction. */
function Body({ body, reach, surface, view }: { body: PlanBody; reach: number; surface: boolean; view: Window }) {
  const { at, radius, rectangle, track } = body
  const [x, y] = [view.x(at), view.y(at)]
  const look = { fill: 'var(--c-obs)', fillOpacity: 0.22, stroke: 'var(--c-obs)', strokeWidth: 1.4 }
  const moving = track.length > 1
  return (
    <g>
      {moving && (
        <>
          <path d={line(track, view)} fill="none" stroke="var(--c-obs)" strokeWidth={1.6} strokeDasharray="5 4" />
          <Head way={track} view={view} colour="var(--c-obs)" />
        </>
      )}
      {rectangle ? (
        <rect
          x={-0.5 * rectangle.length * view.scale}
          y={-0.5 * rectangle.width * view.scale}
          width={rectangle.length * view.scale}
          height={rectangle.width * view.scale}
          transform={`translate(${x} ${y}) rotate(${degrees(-rectangle.angle)})`}
          {...look}
        />
      ) : (
        <circle cx={x} cy={y} r={Math.max(3, radius * view.scale)} {...look} />
      )}
      <Free body={body} reach={reach} surface={surface} x={x} y={y} scale={view.scale} />
    </g>
  )
}

/** An arrow head at the end of a path. */
function Head({ way, view, colour }: { way: Place[]; view: Window; colour: string }) {
  const [from, to] = way.slice(-2)
  if (!from || !to) return null
  const angle = Math.atan2(view.y(to) - view.y(from), view.x(to) - view.x(from))
  return (
    <path
      d="M0 0L-8 3.6L-8 -3.6Z"
      fill={colour}
      transform={`translate(${view.x(to)} ${view.y(to)}) rotate(${degrees(angle)})`}
    />
  )
}


const line = (way: Place[], view: Window): string =>
  way.map((p, i) => `${i === 0 ? 'M' : 'L'}${view.x(p).toFixed(1)} ${view.y(p).toFixed(1)}`).join('')

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
