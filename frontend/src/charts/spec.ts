// What a line chart shows, as data; `Plot` draws it.
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
  /** Its points alone, no line between them. */
  dots?: boolean
  width?: number
  /** Lengths of dashes and gaps; none: a solid line [px]. */
  dash?: readonly number[]
  /** Drawn at the last point. */
  end?: Shape
}

/** A point worth naming, drawn on top. */
export interface Point {
  x: number
  y: number
  colour: string
  label?: string
  line?: string
  /** A ring instead of a dot. */
  hollow?: boolean
}

export interface PlotSpec {
  /** Read out by screen readers: what the chart shows. */
  label: string
  x: readonly number[]
  lines: readonly Line[]
  points?: readonly Point[]
  xTitle?: ReactNode
  yTitle?: ReactNode
  xLog?: boolean
  yLog?: boolean
  xRange?: [number, number]
  yRange?: [number, number]
  /** Ticks of x where the usual ones will not do. */
  xTicks?: readonly number[]
  criterion?: { value: number; label?: string; tint?: boolean; right?: boolean }
  /** Further criteria, where runs with different ones are compared. */
  criteria?: readonly { value: number; label?: string; right?: boolean }[]
  height: number
  /** The head of the tooltip. */
  xText: (x: number) => string
  yText: (y: number) => string
  yTicks?: number
  /** Charts of one key have one crosshair, at the same abscissa. */
  sync?: string
  /** Values at the crosshair stand beside the title of y instead of in a box: for small charts. */
  readout?: boolean
  /** Upright lines across the chart. */
  rules?: readonly { x: number; colour: string }[]
  /** Keeps the left edge of plots that stand below each other in line [px]. */
  left?: number
}
