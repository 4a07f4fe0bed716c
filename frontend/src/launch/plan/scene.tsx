// What every picture of a scenario has: paths, arrow heads, obstacles with the region that must stay free, the goal.
import { clsx } from 'clsx'
import type { ReactNode } from 'react'
import { freeOf, type Place, type Plan, type PlanBody } from './plan'
import { degrees } from './ways'
import { figures } from '../../ui/styles'

/** From positions to the picture. */
export interface Pixels<P = Place> {
  x: (p: P) => number
  y: (p: P) => number
}

export const line = <P,>(way: readonly P[], { x, y }: Pixels<P>): string =>
  way.map((p, i) => `${i === 0 ? 'M' : 'L'}${x(p).toFixed(1)} ${y(p).toFixed(1)}`).join('')

/** What the lines of a picture mean. */
export const Legend = ({ children }: { children: ReactNode }) => <p className={clsx(figures.keys, 'micro mut')}>{children}</p>

export const Key = ({ colour, dash, children }: { colour: string; dash?: string; children: ReactNode }) => (
  <span>
    <svg width={18} height={8} aria-hidden>
      <path d="M0 4h18" stroke={`var(${colour})`} strokeWidth={1.8} strokeDasharray={dash} fill="none" />
    </svg>
    {children}
  </span>
)

/** An arrow head at the end of a path. */
export function Head<P>({ way, pixels, colour }: { way: readonly P[]; pixels: Pixels<P>; colour: string }) {
  const [from, to] = way.slice(-2)
  if (!from || !to) return null
  const [x, y] = [pixels.x(to), pixels.y(to)]
  const angle = Math.atan2(y - pixels.y(from), x - pixels.x(from))
  return <path d="M0 0L-8 3.6L-8 -3.6Z" fill={colour} transform={`translate(${x} ${y}) rotate(${degrees(angle)})`} />
}

/** The vehicle at its start, along its heading. `size`: from its middle to its tip [px]. */
export function Start({ plan: { start, heading }, pixels, size }: { plan: Plan; pixels: Pixels; size: number }) {
  return (
    <path
      d={`M${size} 0L${-0.6 * size} ${0.55 * size}L${-0.3 * size} 0L${-0.6 * size} ${-0.55 * size}Z`}
      transform={`translate(${pixels.x(start)} ${pixels.y(start)}) rotate(${degrees(-heading)})`}
      fill="var(--ink-2)"
    />
  )
}

export function Goal({ at, pixels }: { at: Place; pixels: Pixels }) {
  const [x, y] = [pixels.x(at), pixels.y(at)]
  return (
    <g stroke="var(--ink)" fill="none">
      <path d={`M${x - 5} ${y}h10M${x} ${y - 5}v10`} strokeWidth={1.8} />
      <circle cx={x} cy={y} r={7.5} strokeWidth={1.3} />
    </g>
  )
}

interface ObstacleProps {
  body: PlanBody
  /** The required distance [m]; not drawn for 0. */
  reach: number
  /** Whether it is measured from the surface, not from the centre. */
  surface: boolean
  pixels: Pixels
  /** Pixels per metre. */
  scale: number
}

const BODY = { fill: 'var(--c-obs)', fillOpacity: 0.22, stroke: 'var(--c-obs)', strokeWidth: 1.4 }
const FREE = { fill: 'none', stroke: 'var(--c-crit)', strokeDasharray: '4 3' }

/** An obstacle from above, and the region around it that must stay free: about its centre, or offset from its surface. */
export function Obstacle({ body, reach, surface, pixels, scale }: ObstacleProps) {
  const { at, radius, rectangle } = body
  const [x, y] = [pixels.x(at), pixels.y(at)]
  const round = { cx: x, cy: y }
  const box = (offset: number) => ({
    x: -(0.5 * (rectangle?.length ?? 0) + offset) * scale,
    y: -(0.5 * (rectangle?.width ?? 0) + offset) * scale,
    width: ((rectangle?.length ?? 0) + 2 * offset) * scale,
    height: ((rectangle?.width ?? 0) + 2 * offset) * scale,
    rx: offset * scale,
    transform: `translate(${x} ${y}) rotate(${degrees(-(rectangle?.angle ?? 0))})`,
  })
  const free = surface && rectangle ? <rect {...box(reach)} {...FREE} /> : <circle {...round} r={freeOf(body, reach, surface) * scale} {...FREE} />
  return (
    <>
      {rectangle ? <rect {...box(0)} {...BODY} /> : <circle {...round} r={Math.max(3, radius * scale)} {...BODY} />}
      {reach > 0 && free}
    </>
  )
}
