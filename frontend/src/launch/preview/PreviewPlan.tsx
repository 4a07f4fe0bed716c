// The plan view of the edited scenario: start, goal or course, obstacles with the required distance, paths, uncertain
// geometry, and the nominal flight once simulated.
import { fixed, plain } from '../../format/numbers'
import type { Flown } from './flown'
import { type Area, Frame, RangeBox, timesOf, Way } from './frame'
import { extentOf, fit, freeOf, type Plan, type PlanBody } from '../plan/plan'
import { Goal, Head, Obstacle, type Pixels, Start } from '../plan/scene'
import type { FanRange, Ranges } from './ranges'
import type { Step } from '../plan/ways'
import styles from './preview.module.css'

export interface DrawnProps {
  plan: Plan
  ranges: Ranges
  /** The required distance [m]; 0 if the criterion is not a distance. */
  reach: number
  flown: Flown | null
  /** The flight belongs to an earlier campaign. */
  stale: boolean
  width: number
  label: string
}

const AIR = 12

export function PreviewPlan({ plan, ranges, reach, flown, stale, width, label }: DrawnProps) {
  const area: Area = { left: 38, top: 18, width: width - 46, height: Math.min(260, Math.round(width * 0.66)) }
  const points = [...extentOf(plan, reach), ...flownPoints(flown), ...ranges.boxes.flatMap(({ low, high }) => [low, high])]
  const view = fit(points, area.width, area.height, { x: AIR, y: AIR })
  const pixels: Pixels = { x: (p) => area.left + view.x(p), y: (p) => area.top + view.y(p) }
  const origin = { x: view.x({ x: 0, y: 0 }), y: view.y({ x: 0, y: 0 }) }
  const across: [number, number] = [-origin.x / view.scale, (area.width - origin.x) / view.scale]
  const up: [number, number] = [(origin.y - area.height) / view.scale, origin.y / view.scale]
  const names: [string, string] = plan.axes.ned ? ['East y, m', 'North x, m'] : ['x, m', 'y, m']
  const shared = { pixels, scale: view.scale }
  const times = timesOf(plan.horizon)
  // The axes have numbers, too: an obstacle at the place of the bar is worth more than the bar.
  const covered = plan.bodies.some(({ at: p }) => pixels.x(p) > area.left + area.width - 100 && pixels.y(p) > area.top + area.height - 44)
  const over = (
    <>
      {!covered && <ScaleBar area={area} scale={view.scale} />}
      <North x={area.left + area.width - 14} y={area.top + 6} />
    </>
  )
  return (
    <Frame area={area} across={across} up={up} names={names} width={width} label={label} id="scene-inner" over={over}>
      <Uncertain ranges={ranges} {...shared} fan={0.16 * Math.min(area.width, area.height)} />
      <Way way={plan.way} pixels={pixels} colour="var(--c-nom)" dashed={plan.goal !== null} faint={flown !== null} />
      {!plan.goal && !flown && <Head way={plan.way} pixels={pixels} colour="var(--c-nom)" />}
      {plan.bodies.map((body, i) => (
        <Passing key={i} body={body} way={flown?.intruders.get(i) ?? body.track} times={times} reach={reach} surface={plan.surface} {...shared} />
      ))}
      {flown && <Way way={flown.path} pixels={pixels} colour="var(--c-nom)" times={times} faint={stale} below />}
      {flown && <Closest flown={flown} plan={plan} reach={reach} stale={stale} {...shared} />}
      <Start plan={plan} pixels={pixels} size={12} />
      {plan.goal && <Goal at={plan.goal} pixels={pixels} />}
    </Frame>
  )
}

export const flownPoints = (flown: Flown | null): Step[] =>
  flown ? [...flown.path, ...[...flown.intruders.values()].flat()] : []

interface Shared {
  pixels: Pixels
  /** Pixels per metre. */
  scale: number
}

const RANGE = { fill: 'var(--c-range)', fillOpacity: 0.2, stroke: 'var(--c-range)', strokeOpacity: 0.7, strokeWidth: 1 }

interface ObstacleProps extends Shared {
  body: PlanBody
  way: readonly Step[]
  times: readonly number[]
  reach: number
  surface: boolean
}

/** An obstacle at the start; a moving one with its path. */
function Passing({ body, way, times, ...shared }: ObstacleProps) {
  return (
    <g>
      {body.moving && <Way way={way} pixels={shared.pixels} colour="var(--c-obs)" times={times} dashed />}
      {body.moving && <Head way={way} pixels={shared.pixels} colour="var(--c-obs)" />}
      <Obstacle body={body} {...shared} />
    </g>
  )
}

/** Boxes of positions, fans of headings, rings of radii. */
function Uncertain({ ranges, pixels, scale, fan }: Shared & { ranges: Ranges; fan: number }) {
  return (
    <g>
      {ranges.boxes.map((range) => (
        <RangeBox key={range.path} range={range} pixels={pixels} {...RANGE} />
      ))}
      {ranges.fans.map((range) => (
        <path key={range.path} d={sector(range, pixels, fan)} {...RANGE} />
      ))}
      {ranges.rings.map(({ path, at, low, high }) => (
        <circle
          key={path}
          cx={pixels.x(at)}
          cy={pixels.y(at)}
          r={0.5 * (low + high) * scale}
          fill="none"
          stroke="var(--c-range)"
          strokeOpacity={0.35}
          strokeWidth={Math.max(2, (high - low) * scale)}
        />
      ))}
    </g>
  )
}

function sector({ at, from, to }: FanRange, pixels: Pixels, radius: number): string {
  const [x, y] = [pixels.x(at), pixels.y(at)]
  if (to - from >= 2 * Math.PI) return `M${x - radius} ${y}a${radius} ${radius} 0 1 0 ${2 * radius} 0a${radius} ${radius} 0 1 0 ${-2 * radius} 0`
  const point = (angle: number) => `${x + radius * Math.cos(angle)} ${y - radius * Math.sin(angle)}`
  return `M${x} ${y}L${point(from)}A${radius} ${radius} 0 ${to - from > Math.PI ? 1 : 0} 0 ${point(to)}Z`
}

/** Vehicle and obstacle at the closest approach, with the required distance. */
function Closest({ flown, plan, reach, stale, pixels, scale }: Shared & Pick<DrawnProps, 'plan' | 'reach' | 'stale'> & { flown: Flown }) {
  if (!flown.closest) return null
  const body = plan.bodies[flown.closest.obstacle]
  const free = plan.surface && body?.rectangle ? 0 : body ? freeOf(body, reach, plan.surface) : reach
  const { at, other, value, time, clear } = flown.closest
  const [x0, y0, x1, y1] = [pixels.x(at), pixels.y(at), pixels.x(other), pixels.y(other)]
  const colour = clear ? 'var(--ink)' : 'var(--c-worst)'
  return (
    <g opacity={stale ? 0.45 : 1} data-testid="closest">
      <title>{`Closest approach: ${plain(value)} after ${fixed(time, 2)} s`}</title>
      {free > 0 && <circle cx={x1} cy={y1} r={free * scale} fill="var(--c-obs)" fillOpacity={0.07} stroke="var(--c-crit)" strokeDasharray="4 3" />}
      <path d={`M${x0} ${y0}L${x1} ${y1}`} stroke={colour} strokeWidth={1.6} />
      <circle cx={x0} cy={y0} r={3.4} fill={colour} />
      <circle cx={x1} cy={y1} r={3} fill="var(--c-obs)" stroke={colour} />
    </g>
  )
}

/** A round length near a quarter of the width. */
function ScaleBar({ area, scale }: { area: Area; scale: number }) {
  const most = (0.3 * area.width) / scale
  const power = 10 ** Math.floor(Math.log10(most))
  const length = ([5, 2, 1].find((m) => m * power <= most) ?? 1) * power
  const [x, y] = [area.left + area.width - 8, area.top + area.height - 8]
  return (
    <g className={styles.bar}>
      <path d={`M${x} ${y - 4}v4h${-length * scale}v-4`} fill="none" stroke="var(--ink-2)" strokeWidth={1.3} />
      <text x={x - 0.5 * length * scale} y={y - 5} textAnchor="middle">
        {plain(length)} m
      </text>
    </g>
  )
}

function North({ x, y }: { x: number; y: number }) {
  return (
    <g className={styles.bar}>
      <path d={`M${x} ${y + 22}V${y + 2}M${x - 3.5} ${y + 8}L${x} ${y + 1}L${x + 3.5} ${y + 8}`} fill="none" stroke="var(--ink-2)" strokeWidth={1.4} />
      <text x={x - 7} y={y + 10} textAnchor="end">
        N
      </text>
    </g>
  )
}
