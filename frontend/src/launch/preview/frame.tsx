// Shared elements of the preview's drawings: a frame with axes and grid, marks along a path, arrows. Start: `Frame`.
import type { ReactNode, SVGProps } from 'react'
import { linearTicks, tickText } from '../../charts/ticks'
import { line, type Pixels } from '../plan/scene'
import { at, type Step } from '../plan/ways'
import type { BoxRange } from './ranges'
import styles from './preview.module.css'

/** The plot area [px]. */
export interface Area {
  left: number
  top: number
  width: number
  height: number
}

interface AxesProps {
  area: Area
  /** The value ranges of the plot area, left to right and bottom to top. */
  across: [number, number]
  up: [number, number]
  names: [string, string]
}

/** Grid lines at round values, their numbers, and the names of both axes with their units. */
function Axes2({ area, across, up, names }: AxesProps) {
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

interface FrameProps extends AxesProps {
  /** Of the whole picture. */
  width: number
  label: string
  /** Distinguishes the pictures of a page. */
  id: string
  /** What is drawn over the plot area, not cut at its edge. */
  over?: ReactNode
  children: ReactNode
}

/** A picture with axes; what is drawn in it is cut at the edge of its plot area. */
export function Frame({ width, label, id, over, children, ...axes }: FrameProps) {
  const { left, top, ...size } = axes.area
  return (
    <svg className={styles.scene} width={width} height={top + size.height + 30} role="img" aria-label={label}>
      <Axes2 {...axes} />
      <clipPath id={id}>
        <rect x={left} y={top} {...size} />
      </clipPath>
      <g clipPath={`url(#${id})`}>{children}</g>
      {over}
    </svg>
  )
}

interface RangeBoxProps extends SVGProps<SVGRectElement> {
  range: BoxRange
  pixels: Pixels<Step>
}

/** The box of an uncertain position; one that is certain in a direction is a bar. */
export function RangeBox({ range: { low, high }, pixels, ...look }: RangeBoxProps) {
  const [x0, x1] = [pixels.x(low), pixels.x(high)].sort((a, b) => a - b) as [number, number]
  const [y0, y1] = [pixels.y(low), pixels.y(high)].sort((a, b) => a - b) as [number, number]
  const [w, h] = [Math.max(4, x1 - x0), Math.max(4, y1 - y0)]
  return <rect x={(x0 + x1 - w) / 2} y={(y0 + y1 - h) / 2} width={w} height={h} {...look} />
}

interface WayProps {
  way: readonly Step[]
  pixels: Pixels<Step>
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
  const labels = spread(marks)
  return (
    <g opacity={faint ? 0.45 : 1}>
      <path d={line(way, pixels)} fill="none" stroke={colour} strokeWidth={1.8} strokeDasharray={dashed ? '5 4' : undefined} />
      {marks.map((mark) => (
        <circle key={mark.time} cx={mark.x} cy={mark.y} r={2.2} fill={colour} />
      ))}
      {labels.map((mark) => (
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

/** Round times within the horizon for the marks along paths. */
export const timesOf = (horizon: number): number[] => (horizon > 0 ? linearTicks(0, horizon, 6).filter((t) => t > 0) : [])
