// Draws evaluations on canvases: lines across parallel axes, points in cells. Elements of one colour are drawn in one path,
// the lowest values last, so that they are on top.
import { colour } from '../../charts/draw'
import type { Theme } from '../../theme/useTheme'
import { SHADES, shadeOf, shades } from './colours'
import { type Axis, shareOf, type Space } from './space'

/** Layout of the parallel view [px]. */
export interface Lines {
  xs: number[]
  top: number
  bottom: number
  /** Position of evaluations without a value on the value's axis. */
  none: number
}

/** One pair of axes, by their indices in `Space.axes`, and its position [px]. */
export interface Cell {
  x: number
  y: number
  left: number
  top: number
  width: number
  height: number
}

export interface Ink {
  theme: Theme
  /** The values at the ends of the colour scale. */
  low: number
  high: number
  /** Index of the axis that gives the values. */
  axis: number
  /** Whether high values are emphasised instead of low ones. */
  turned: boolean
}

/** Maximum number of marks in one path; beyond it Chromium's rasteriser is faster with several paths. */
const AT_ONCE = 40

/**
 * Maximum number of dashed lines; of more, no dash can be seen. Drawing 4,000 without a graphics card takes 20 s of
 * Chromium's graphics process, in which the page and the 3D view stand still.
 */
export const DASHED = 400

/** The dashes of so many lines. */
export const dashOf = (lines: number, dash: readonly number[]): number[] => (lines > DASHED ? [] : [...dash])

/** Stroke what is drawn for each row, in several paths. */
function inParts(ctx: CanvasRenderingContext2D, rows: readonly number[], draw: (row: number) => void): void {
  for (let first = 0; first < rows.length; first += AT_ONCE) {
    ctx.lineDashOffset = (first / AT_ONCE) * 3 // aligned dashes would look like rings
    ctx.beginPath()
    rows.slice(first, first + AT_ONCE).forEach(draw)
    ctx.stroke()
  }
}

/** The canvas at its element's size, cleared; units are CSS pixels. */
export function prepared(canvas: HTMLCanvasElement, width: number, height: number): CanvasRenderingContext2D | null {
  const ratio = devicePixelRatio
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)]
  if (canvas.width !== w) canvas.width = w
  if (canvas.height !== h) canvas.height = h
  const ctx = canvas.getContext('2d')
  if (!ctx) return null
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0)
  ctx.clearRect(0, 0, width, height)
  return ctx
}

/** Rows by shade, most prominent first; then those without a value. */
export function layersOf(
  space: Space,
  kept: Uint32Array,
  { low, high, axis, turned }: Ink,
): { fates: number[][]; shaded: number[][] } {
  const fates: number[][] = [[], [], []]
  const shaded: number[][] = Array.from({ length: SHADES }, () => [])
  const values = space.columns[axis] as Float64Array
  for (const i of kept) {
    const value = values[i] as number
    const fate = space.fates[i] || (Number.isNaN(value) ? 1 : 0)
    const shade = shadeOf(value, low, high)
    if (fate === 0) shaded[turned ? SHADES - 1 - shade : shade]?.push(i)
    else fates[fate]?.push(i)
  }
  return { fates, shaded }
}

/** The heights at which an evaluation crosses the axes [px]. */
export function crossings(space: Space, i: number, { top, bottom, none }: Lines): number[] {
  return space.axes.map((_, k) => crossing(space, i, k, { top, bottom, none }))
}

function crossing(space: Space, i: number, k: number, { top, bottom, none }: Omit<Lines, 'xs'>): number {
  const value = space.columns[k]?.[i] as number
  return Number.isNaN(value) ? none : bottom - shareOf(space.axes[k] as Axis, value) * (bottom - top)
}

export function paintLines(ctx: CanvasRenderingContext2D, space: Space, kept: Uint32Array, ink: Ink, lines: Lines): void {
  const { fates, shaded } = layersOf(space, kept, ink)
  ctx.lineWidth = 1
  ctx.lineJoin = 'bevel'
  const stroke = (rows: number[]) =>
    inParts(ctx, rows, (i) => {
      crossings(space, i, lines).forEach((y, k) => {
        const x = lines.xs[k] as number
        if (k === 0) ctx.moveTo(x, y)
        else ctx.lineTo(x, y)
      })
    })
  ctx.strokeStyle = colour('--ink-3')
  for (const [rows, dash] of [[fates[1] ?? [], [4, 3]], [fates[2] ?? [], [1, 3]]] as const) {
    // They all start at one point: many of them must not be more prominent than those with a value.
    ctx.globalAlpha = rows.length > 2000 ? 0.03 : rows.length > DASHED ? 0.1 : rows.length > 80 ? 0.35 : 0.6
    ctx.setLineDash(dashOf(rows.length, dash))
    stroke(rows)
  }
  ctx.setLineDash([])
  ctx.lineDashOffset = 0
  ctx.globalAlpha = kept.length > 2000 ? 0.15 : kept.length > 400 ? 0.4 : 0.85
  const palette = shades(ink.theme)
  for (let shade = SHADES - 1; shade >= 0; shade--) {
    ctx.strokeStyle = palette[shade] as string
    stroke(shaded[shade] as number[])
  }
  ctx.globalAlpha = 1
}

/** The position of an evaluation in a cell [px]; NaN without a value. */
export function placed(space: Space, i: number, cell: Cell): [number, number] {
  const x = shareOf(space.axes[cell.x] as Axis, space.columns[cell.x]?.[i] as number)
  const y = shareOf(space.axes[cell.y] as Axis, space.columns[cell.y]?.[i] as number)
  return [cell.left + x * cell.width, cell.top + (1 - y) * cell.height]
}

export function paintPoints(
  ctx: CanvasRenderingContext2D,
  space: Space,
  kept: Uint32Array,
  ink: Ink,
  cells: readonly Cell[],
): void {
  const { fates, shaded } = layersOf(space, kept, ink)
  const size = kept.length > 1500 ? 2.5 : 3.5
  const palette = shades(ink.theme)
  ctx.strokeStyle = colour('--ink-3')
  for (const cell of cells) {
    ctx.lineWidth = 1
    for (const i of fates[2] ?? []) {
      const [x, y] = placed(space, i, cell)
      if (!Number.isNaN(x + y)) ctx.strokeRect(x - 2.5, y - 2.5, 5, 5)
    }
    inParts(ctx, fates[1] ?? [], (i) => {
      const [x, y] = placed(space, i, cell)
      if (!Number.isNaN(x + y)) cross(ctx, x, y)
    })
    for (let shade = SHADES - 1; shade >= 0; shade--) {
      ctx.fillStyle = palette[shade] as string
      for (const i of shaded[shade] as number[]) {
        const [x, y] = placed(space, i, cell)
        ctx.fillRect(x - size / 2, y - size / 2, size, size)
      }
    }
  }
}

function cross(ctx: CanvasRenderingContext2D, x: number, y: number): void {
  ctx.moveTo(x - 2.5, y - 2.5)
  ctx.lineTo(x + 2.5, y + 2.5)
  ctx.moveTo(x + 2.5, y - 2.5)
  ctx.lineTo(x - 2.5, y + 2.5)
}

/** The evaluation whose line is nearest to a position, at most `reach` [px] above or below it. */
export function lineNear(space: Space, kept: Uint32Array, lines: Lines, x: number, y: number, reach = 6): number | null {
  const right = Math.max(1, lines.xs.findIndex((at) => at >= x))
  const [from, to] = [lines.xs[right - 1], lines.xs[right]]
  if (from === undefined || to === undefined || x < from - reach || x > to + reach) return null
  const share = (x - from) / (to - from)
  return nearestOf(kept, reach, (i) => Math.abs(crossing(space, i, right - 1, lines) * (1 - share) + crossing(space, i, right, lines) * share - y))
}

/** The evaluation nearest to a position in a cell, at most `reach` [px] away. */
export function pointNear(space: Space, kept: Uint32Array, cell: Cell, x: number, y: number, reach = 8): number | null {
  return nearestOf(kept, reach, (i) => {
    const [px, py] = placed(space, i, cell)
    return Math.hypot(px - x, py - y)
  })
}

function nearestOf(kept: Uint32Array, reach: number, distance: (i: number) => number): number | null {
  let [nearest, least]: [number | null, number] = [null, reach]
  for (const i of kept) {
    const off = distance(i)
    if (off <= least) [nearest, least] = [i, off]
  }
  return nearest
}
