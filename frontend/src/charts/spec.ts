// The specification of a line chart; `Plot` draws it.
import type { ReactNode } from 'react'
import type { Shape } from '../ui/methods'

export interface Line {
  key: string
  /** Plain text: for the tooltip. */
  label: string
  /** CSS variable of the colour. */
  colour: string
  y: readonly (number | null)[]
  stepped?: boolean
  /** Only points, no line. */
  dots?: boolean
  width?: number
  /** Lengths of dashes and gaps; empty for a solid line [px]. */
  dash?: readonly number[]
  /** Drawn at the last point. */
  end?: Shape
  /** The value at each point in words, if not as `yText` writes it. */
  texts?: readonly string[]
}

/** A labelled point, drawn on top. */
export interface Point {
  x: number
  y: number
  colour: string
  label?: string
  line?: string
  /** A ring instead of a dot. */
  hollow?: boolean
}

/** The value of a line at a point, for the readout and the tooltip. */
export const valueText = (spec: Pick<PlotSpec, 'yText'>, line: Line, at: number): string =>
  line.texts?.[at] ?? spec.yText(line.y[at] as number)

export interface PlotSpec {
  /** Description for screen readers. */
  label: string
  x: readonly number[]
  lines: readonly Line[]
  points?: readonly Point[]
  xTitle?: ReactNode
  yTitle?: ReactNode
  xLog?: boolean
  xRange?: [number, number]
  yRange?: [number, number]
  xTicks?: readonly number[]
  /** Whether x is a time in seconds since 1970, with ticks at round times of the reader's zone. */
  xTime?: boolean
  criterion?: { value: number; label?: string; tint?: boolean; right?: boolean }
  /** Further criteria, if runs with different ones are compared. */
  criteria?: readonly { value: number; label?: string; right?: boolean }[]
  height: number
  /** The heading of the tooltip. */
  xText: (x: number) => string
  yText: (y: number) => string
  yTicks?: number
  /** Charts with the same key share a crosshair. */
  sync?: string
  /** Shows values at the crosshair next to the title of y instead of in a box, for small charts. */
  readout?: boolean
  /** Vertical lines across the chart. */
  rules?: readonly { x: number; colour: string }[]
  /** Width of the left axis, to align stacked plots [px]. */
  left?: number
}
