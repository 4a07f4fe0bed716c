// The side view of a scenario: heights over the distance along the vehicle's path, if heights differ.
import { padded } from '../../charts/ticks'
import { type Area, Frame, RangeBox, timesOf, Way } from './frame'
import { freeOf, type Plan } from '../plan/plan'
import { Head, type Pixels } from '../plan/scene'
import { type DrawnProps, flownPoints } from './PreviewPlan'
import type { Step } from '../plan/ways'

/** Whether a side view is useful: different heights, or objects with a height. */
export function hasHeights({ plan, flown, ranges }: Pick<DrawnProps, 'plan' | 'flown' | 'ranges'>): boolean {
  if (!plan.space) return false
  const ups = [...placesOf(plan), ...flownPoints(flown), ...ranges.boxes.flatMap(({ low, high }) => [low, high])].map((p) => p.up)
  return Math.max(...ups) - Math.min(...ups) > 0.05 || plan.bodies.some((body) => body.height !== null)
}

const placesOf = (plan: Plan): Step[] => [plan.start, ...plan.way, ...plan.bodies.flatMap((b) => [b.at, ...b.track])]

export function PreviewSide(props: DrawnProps) {
  const { plan, ranges, reach, flown, stale, width, label } = props
  const area: Area = { left: 38, top: 18, width: width - 46, height: 84 }
  const along = alongOf(plan)
  const places = [...placesOf(plan), ...flownPoints(flown)]
  const around = plan.bodies.flatMap(({ at, height, radius }) => {
    const tall = height === null ? radius : height / 2
    const far = plan.surface ? tall + reach : Math.max(reach, radius, tall)
    return [at.up - far, at.up + far]
  })
  const wide = plan.bodies.flatMap(({ at, radius }) => [along(at) - Math.max(reach, radius), along(at) + Math.max(reach, radius)])
  const across = padded([...places.map(along), ...wide], 0.03)
  const up = padded([...places.map((p) => p.up), ...around], 0.08)
  const kx = area.width / (across[1] - across[0])
  const ky = area.height / (up[1] - up[0])
  const pixels: Pixels<Step> = {
    x: (p) => area.left + (along(p) - across[0]) * kx,
    y: (p) => area.top + area.height - (p.up - up[0]) * ky,
  }
  const times = timesOf(plan.horizon)
  return (
    <Frame area={area} across={across} up={up} names={['Along the path, m', 'Height, m']} width={width} label={label} id="side-inner">
      {ranges.boxes.map((range) => (
        <RangeBox key={range.path} range={range} pixels={pixels} fill="var(--c-range)" fillOpacity={0.25} />
      ))}
      <Way way={plan.way} pixels={pixels} colour="var(--c-nom)" dashed={plan.goal !== null} faint={flown !== null} />
      {plan.bodies.map((body, i) => {
        const way = flown?.intruders.get(i) ?? body.track
        const [x, y] = [pixels.x(body.at), pixels.y(body.at)]
        const tall = (body.height ?? 2 * body.radius) * ky
        // The outline that must stay free is not drawn from the side for objects with a height.
        const free = plan.surface && body.height !== null ? 0 : freeOf(body, reach, plan.surface)
        const broad = Math.max(6, 2 * body.radius * kx)
        return (
          <g key={i}>
            {body.moving && <Way way={way} pixels={pixels} colour="var(--c-obs)" dashed />}
            {body.moving && <Head way={way} pixels={pixels} colour="var(--c-obs)" />}
            {body.height === null ? (
              <ellipse cx={x} cy={y} rx={broad / 2} ry={Math.max(3, tall / 2)} fill="var(--c-obs)" fillOpacity={0.25} stroke="var(--c-obs)" />
            ) : (
              <rect x={x - broad / 2} y={y - tall / 2} width={broad} height={tall} fill="var(--c-obs)" fillOpacity={0.25} stroke="var(--c-obs)" />
            )}
            {free > 0 && (
              <ellipse cx={x} cy={y} rx={free * kx} ry={free * ky} fill="none" stroke="var(--c-crit)" strokeDasharray="4 3" />
            )}
          </g>
        )
      })}
      {flown && <Way way={flown.path} pixels={pixels} colour="var(--c-nom)" times={times} faint={stale} />}
      {flown?.closest && (
        <circle cx={pixels.x(flown.closest.at)} cy={pixels.y(flown.closest.at)} r={3.4} fill="var(--ink)" opacity={stale ? 0.45 : 1} />
      )}
      <circle cx={pixels.x(plan.start)} cy={pixels.y(plan.start)} r={4} fill="var(--ink-2)" />
    </Frame>
  )
}

/** The distance of a position from the start along the straight path, or along the heading if there is none [m]. */
function alongOf(plan: Plan): (p: Step) => number {
  const { start, heading, way } = plan
  const end = way.at(-1)
  const [dx, dy] = end ? [end.x - start.x, end.y - start.y] : [0, 0]
  const length = Math.hypot(dx, dy)
  const [ux, uy] = length > 0 ? [dx / length, dy / length] : [Math.cos(heading), Math.sin(heading)]
  return (p) => (p.x - start.x) * ux + (p.y - start.y) * uy
}
