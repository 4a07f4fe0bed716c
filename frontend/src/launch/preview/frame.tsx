// Shared elements of the preview's drawings: a frame with axes and grid, marks along a path, arrows. Start: `Axes2`.
import { linearTicks, tickText } from '../../charts/ticks'
import { at, degrees, type Step } from '../plan/ways'
import styles from './preview.module.css'

/** The plot area [px]. */
export interface Area {
  left: number
  top: number
  width: number
  height: number
}

export interface Pixels {
  x: (step: Step) => number
  y: (step: Step) => number
}

interface AxesProps {
  area: Area
  /** The value ranges of the plot area, left to right and bottom to top. */
  across: [number, number]
  up: [number, number]
  names: [string, string]
}

/** Grid lines at round values, their numbers, and the names of both axes with their units. */
export function Axes2({ area, across, up, names }: AxesProps) {
  const { left, top, width, height } = area
  const columns = linearTicks(...across, Math.max(2, width / 70))
  const rows = linearTicks(...up, Math.max(3, height / 46))
  const x = (value: number) => left + ((value - across[0]) / (across[1] - across[0])) * width
  const y = (value: number) => top + height - ((value - up[0]) / (up[1] - up[0])) * height
  return (
    <g>
      <rect x={left} y={top} width={width} height={height} fill="var(--vp)" />
      <path
        d={[...columns.map((v) => `M${x(v)} ${top}v${height}`), ...rows.map((v) => `M${left} ${y(v)}h${width}`)].join('')}
        stroke="var(--vp-line)"
        strokeWidth={0.7}
      />
      {columns.map((v) => (
        <text key={v} x={x(v)} y={top + height + 13} textAnchor="middle">
          {tickText(columns)(v)}
        </text>
      ))}
      {rows
        .filter((v) => y(v) > top + 8)
        .map((v) => (
        <text key={v} x={left - 5} y={y(v) + 3.5} textAnchor="end">
          {tickText(rows)(v)}
        </text>
      ))}
      <text x={left + width / 2} y={top + height + 26} textAnchor="middle" className={styles.name}>
        {names[0]}
      </text>
      <text x={2} y={top - 5} className={styles.name}>
        {names[1]}
      </text>
    </g>
  )
}

export const line = (way: readonly Step[], { x, y }: Pixels): string =>
  way.map((p, i) => `${i === 0 ? 'M' : 'L'}${x(p).toFixed(1)} ${y(p).toFixed(1)}`).join('')

interface WayProps {
  way: readonly Step[]
  pixels: Pixels
  colour: string
  /** Times of the dots [s], labelled if there is room. */
  times?: readonly number[]
  dashed?: boolean
  faint?: boolean
  /** Labels are below and before the dots, so that those of two paths do not overlap. */
  below?: boolean
}

/** A path with dots at equal intervals, labelled if the dots are far enough apart. */
export function Way({ way, pixels, colour, times = [], dashed, faint, below }: WayProps) {
  const marks = times.flatMap((time) => {
    const step = at(way, time)
    return step ? [{ time, x: pixels.x(step), y: pixels.y(step) }] : []
  })
  const told = spread(marks)
  return (
    <g opacity={faint ? 0.45 : 1}>
      <path d={line(way, pixels)} fill="none" stroke={colour} strokeWidth={1.8} strokeDasharray={dashed ? '5 4' : undefined} />
      {marks.map((mark) => (
        <circle key={mark.time} cx={mark.x} cy={mark.y} r={2.2} fill={colour} />
      ))}
      {told.map((mark) => (
        <text
          key={mark.time}
          x={mark.x + (below ? -4 : 5)}
          y={mark.y + (below ? 13 : -4)}
          textAnchor={below ? 'end' : 'start'}
          className={styles.time}
        >
          {tickText(times)(mark.time)} s
        </text>
      ))}
    </g>
  )
}

/** The marks that are far enough apart to be labelled. */
function spread<T extends { x: number; y: number }>(marks: readonly T[]): T[] {
  const kept: T[] = []
  for (const mark of marks) if (kept.every((one) => Math.hypot(one.x - mark.x, one.y - mark.y) >= 34)) kept.push(mark)
  return kept
}

/** An arrow head at the end of a path. */
export function Head({ way, pixels, colour }: { way: readonly Step[]; pixels: Pixels; colour: string }) {
  const [from, to] = way.slice(-2)
  if (!from || !to) return null
  const [x, y] = [pixels.x(to), pixels.y(to)]
  const angle = Math.atan2(y - pixels.y(from), x - pixels.x(from))
  return <path d="M0 0L-8 3.6L-8 -3.6Z" fill={colour} transform={`translate(${x} ${y}) rotate(${degrees(angle)})`} />
}

/** Round times within the horizon for the marks along paths. */
export const timesOf = (horizon: number): number[] => (horizon > 0 ? linearTicks(0, horizon, 6).filter((t) => t > 0) : [])
