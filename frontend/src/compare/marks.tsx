// A common axis for values of several runs, and their markers: the first filled, the second hollow, the
// third and fourth smaller.
import { linearTicks, padded, tickText } from '../charts/ticks'
import { figures } from '../ui/styles'

export interface Axis {
  width: number
  x: (value: number) => number
  ticks: number[]
  /** The criteria near enough to be shown. */
  shown: number[]
}

/** An axis of that width [px] for these values, and for criteria within three times their spread. */
export function axisOf(values: readonly number[], limits: readonly number[], width: number, edge: number): Axis {
  const spread = Math.max(...values) - Math.min(...values)
  const shown = limits.filter((limit) => Math.min(...values.map((v) => Math.abs(v - limit))) <= 3 * spread)
  const [low, high] = padded([...values, ...shown])
  const x = (value: number) => edge + ((width - 2 * edge) * (value - low)) / (high - low)
  return { width, x, ticks: linearTicks(low, high, 5), shown }
}

/** The tick labels of the axis, as a column header. */
export const AxisHead = ({ axis: { width, x, ticks } }: { axis: Axis }) => (
  <svg className={figures.ch} width={width} height={14} style={{ width }} aria-hidden="true">
    {ticks.map((tick) => (
      <text key={tick} x={x(tick)} y={11} textAnchor="middle">
        {tickText(ticks)(tick)}
      </text>
    ))}
  </svg>
)

export const MarkKeys = ({ letters }: { letters: readonly string[] }) => (
  <span className={figures.lg}>
    {letters.map((letter, i) => (
      <span key={letter} className={figures.k}>
        <svg width={14} height={14} aria-hidden="true">
          <Mark x={7} y={7} index={i} colour="var(--ink-2)" />
        </svg>
        {letter}
      </span>
    ))}
  </span>
)

interface MarkProps {
  x: number
  y: number
  index: number
  colour: string
}

export function Mark({ x, y, index, colour }: MarkProps) {
  return (
    <circle
      cx={x}
      cy={y}
      r={index < 2 ? 4 : 2.6}
      fill={index % 2 === 0 ? colour : 'var(--surface)'}
      stroke={colour}
      strokeWidth={1.6}
    />
  )
}

/** A line between two values, dashed for all runs but the first. */
export function Span({ from, to, y, index }: { from: number; to: number; y: number; index: number }) {
  const colour = 'var(--ink-2)'
  return (
    <>
      <path
        d={`M${from} ${y}H${to}`}
        stroke={colour}
        strokeWidth={1.8}
        strokeDasharray={index === 0 ? undefined : '4 3'}
      />
      <Mark x={from} y={y} index={index} colour={colour} />
      <Mark x={to} y={y} index={index} colour={colour} />
    </>
  )
}
