// The axes of charts that are drawn as SVG: ticks with their labels and lines across the drawing, and a title.
import type { ReactNode } from 'react'
import { figures } from '../ui/styles'
import { tickText } from './ticks'

interface TicksProps {
  ticks: readonly number[]
  /** The position of a tick [px]. */
  at: (tick: number) => number
  text?: (tick: number) => string
}

interface BelowProps extends TicksProps {
  /** The height of the axis, below which the labels are [px]. */
  foot: number
  /** The upper end of the lines; without it there are none [px]. */
  top?: number
}

export function TicksBelow({ ticks, at, text = tickText(ticks), foot, top }: BelowProps) {
  return ticks.map((tick) => (
    <g key={tick}>
      {top !== undefined && <path className={figures.g} d={`M${at(tick)} ${top}V${foot}`} />}
      <text x={at(tick)} y={foot + 15} textAnchor="middle">
        {text(tick)}
      </text>
    </g>
  ))
}

/** From the left to the right end of the drawing [px]. */
export function TicksBeside({ ticks, at, text = tickText(ticks), from, to }: TicksProps & { from: number; to: number }) {
  return ticks.map((tick) => (
    <g key={tick}>
      <path className={figures.g} d={`M${from} ${at(tick)}H${to}`} />
      <text x={from - 6} y={at(tick) + 4} textAnchor="end">
        {text(tick)}
      </text>
    </g>
  ))
}

export function AxisBelow({ from, to, title, ...ticks }: BelowProps & { from: number; to: number; title: ReactNode }) {
  return (
    <>
      <TicksBelow {...ticks} />
      <path className={figures.a} d={`M${from} ${ticks.foot}H${to}`} />
      <text x={(from + to) / 2} y={ticks.foot + 34} textAnchor="middle">
        {title}
      </text>
    </>
  )
}
