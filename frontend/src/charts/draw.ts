// Drawn on top of uPlot's lines: the criterion with its shaded side, labelled points, markers at line ends.
import type uPlot from 'uplot'
import { isOpen, OUTLINE, type Shape } from '../ui/methods'
import type { PlotSpec, Point } from './spec'

const colours = new Map<string, string>()

/** The value of a CSS variable, for canvases; read once for each theme, because reading forces styles to be computed. */
export function colour(name: string): string {
  const root = document.documentElement
  const key = `${root.dataset.theme} ${name}`
  const found = colours.get(key) ?? getComputedStyle(root).getPropertyValue(name).trim()
  if (found) colours.set(key, found)
  return found
}

/** The violating side of the criterion, below everything else. */
export function drawTint(u: uPlot, spec: PlotSpec): void {
  if (!spec.criterion?.tint) return
  const { ctx, bbox } = u
  const y = clamp(u.valToPos(spec.criterion.value, 'y', true), bbox.top, bbox.top + bbox.height)
  ctx.save()
  ctx.globalAlpha = 0.055
  ctx.fillStyle = colour('--bad-solid')
  ctx.fillRect(bbox.left, y, bbox.width, bbox.top + bbox.height - y)
  ctx.restore()
}

/** Vertical lines, below the curves' markers. */
export function drawRules(u: uPlot, spec: PlotSpec): void {
  const { bbox } = u
  for (const rule of spec.rules ?? []) {
    const x = u.valToPos(rule.x, 'x', true)
    if (x < bbox.left || x > bbox.left + bbox.width) continue
    dashed(u, rule.colour, 1, [2, 3], [x, bbox.top], [x, bbox.top + bbox.height])
  }
}

/** A dashed line of this width; the lengths of dashes and gaps are in CSS pixels, too. */
function dashed({ ctx }: uPlot, name: string, width: number, dash: readonly number[], from: [number, number], to: [number, number]): void {
  ctx.save()
  ctx.strokeStyle = colour(name)
  ctx.lineWidth = width * devicePixelRatio
  ctx.setLineDash(dash.map((length) => length * devicePixelRatio))
  ctx.beginPath()
  ctx.moveTo(...from)
  ctx.lineTo(...to)
  ctx.stroke()
  ctx.restore()
}

export function drawCriteria(u: uPlot, spec: PlotSpec): void {
  if (spec.criterion) drawCriterion(u, spec.criterion)
  for (const criterion of spec.criteria ?? []) drawCriterion(u, criterion)
}

function drawCriterion(u: uPlot, criterion: { value: number; label?: string; right?: boolean }): void {
  const { bbox } = u
  const y = u.valToPos(criterion.value, 'y', true)
  if (y < bbox.top - 1 || y > bbox.top + bbox.height + 1) return
  const ratio = devicePixelRatio
  dashed(u, '--c-crit', 1.25, [5, 4], [bbox.left, y], [bbox.left + bbox.width, y])
  if (!criterion.label) return
  const x = criterion.right ? bbox.left + bbox.width - 6 * ratio : bbox.left + 6 * ratio
  text(u, criterion.label, x, y - 8 * ratio, '--ink', criterion.right ? 'right' : 'left')
}

/** Labelled points. Labels are below the points, stacked if points are close together. */
export function drawPoints(u: uPlot, points: readonly Point[], criterion?: number): void {
  const ratio = devicePixelRatio
  const placed = points.map((p) => ({ ...p, px: u.valToPos(p.x, 'x', true), py: u.valToPos(p.y, 'y', true) }))
  for (const point of placed) dot(u, point.px, point.py, point.colour, point.hollow)
  const line = criterion === undefined ? null : u.valToPos(criterion, 'y', true)
  let last = { x: Number.NEGATIVE_INFINITY, y: Number.NEGATIVE_INFINITY, half: 0 }
  for (const { label, px, py, colour: name } of placed) {
    if (!label) continue
    const half = measure(u, label) / 2
    const x = clamp(px, u.bbox.left + half + 2, u.bbox.left + u.bbox.width - half - 2)
    const beside = Math.abs(x - last.x) < half + last.half + 8 * ratio
    const below = beside ? Math.max(py + 16 * ratio, last.y + 15 * ratio) : py + 16 * ratio
    // Not on the criterion's line, which would cross out the text.
    const y = line !== null && Math.abs(below - line) < 9 * ratio ? line + 11 * ratio : below
    text(u, label, x, y, name === '--c-worst' ? '--bad' : '--ink-2', 'center')
    last = { x, y, half }
  }
}

function dot(u: uPlot, x: number, y: number, name: string, hollow = false): void {
  const { ctx } = u
  ctx.save()
  ctx.beginPath()
  ctx.arc(x, y, 3.8 * devicePixelRatio, 0, 2 * Math.PI)
  ctx.fillStyle = colour(hollow ? '--surface' : name)
  ctx.strokeStyle = colour(hollow ? name : '--surface')
  ctx.lineWidth = 1.6 * devicePixelRatio
  ctx.fill()
  ctx.stroke()
  ctx.restore()
}

export function drawEnds(u: uPlot, spec: PlotSpec): void {
  spec.lines.forEach((line, i) => {
    if (!line.end || !u.series[i + 1]?.show) return
    let last = line.y.length - 1
    while (last >= 0 && line.y[last] === null) last--
    const value = line.y[last]
    if (value === null || value === undefined) return
    marker(u, line.end, line.colour, u.valToPos(spec.x[last] as number, 'x', true), u.valToPos(value, 'y', true))
  })
}

function marker(u: uPlot, shape: Shape, name: string, x: number, y: number): void {
  const { ctx } = u
  const scale = devicePixelRatio * 0.95
  const path = new Path2D(OUTLINE[shape])
  ctx.save()
  ctx.translate(x - 5 * scale, y - 5 * scale)
  ctx.scale(scale, scale)
  ctx.lineWidth = isOpen(shape) ? 4 : 1.5
  ctx.strokeStyle = colour('--surface')
  ctx.stroke(path)
  if (isOpen(shape)) {
    ctx.lineWidth = 1.9
    ctx.strokeStyle = colour(name)
    ctx.stroke(path)
  } else {
    ctx.fillStyle = colour(name)
    ctx.fill(path)
  }
  ctx.restore()
}

export const font = (weight = 400): string =>
  `${weight} ${11 * devicePixelRatio}px "Inter Variable", system-ui, sans-serif`

function measure(u: uPlot, words: string): number {
  u.ctx.save()
  u.ctx.font = font(500)
  const width = u.ctx.measureText(words).width
  u.ctx.restore()
  return width
}

function text(u: uPlot, words: string, x: number, y: number, ink: string, align: CanvasTextAlign): void {
  const { ctx } = u
  ctx.save()
  ctx.font = font(500)
  ctx.textAlign = align
  ctx.textBaseline = 'middle'
  ctx.lineJoin = 'round'
  ctx.lineWidth = 3 * devicePixelRatio
  ctx.strokeStyle = colour('--surface')
  ctx.strokeText(words, x, y)
  ctx.fillStyle = colour(ink)
  ctx.fillText(words, x, y)
  ctx.restore()
}

const clamp = (value: number, low: number, high: number): number => Math.min(Math.max(value, low), high)
