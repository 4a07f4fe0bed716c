// Parallel coordinates: one line for each evaluation, one axis for the value and every parameter. A range is drawn on
// an axis by dragging, and moved by its handles or by keys.
import { clsx } from 'clsx'
import { type KeyboardEvent, useCallback, useMemo, useRef } from 'react'
import { decimalsFor, fixed } from '../../format/numbers'
import { unitText } from '../../format/units'
import { symbolText, SvgSign } from '../../ui/Sign'
import { useWidth } from '../../ui/useWidth'
import { Layer } from './Layer'
import { crossings, type Ink, type Lines, lineNear, paintLines } from './paint'
import { type Axis, type Brush, nudged, rangeOn, shareOf, type Space, valueAt } from './space'
import { useDrag } from './useDrag'
import { figures } from '../../ui/styles'
import styles from './space.module.css'

const [TOP, SIDE, NONE_BELOW, HANDLE] = [44, 50, 22, 8]

export interface ViewProps {
  space: Space
  kept: Uint32Array
  brush: Brush
  onBrush: (axis: Axis, range: readonly [number, number] | null) => void
  ink: Ink
  /** Drawn on top: the lowest selected one, and the one pointed at. */
  worst: number | null
  over: number | null
  onOver: (evaluation: number | null) => void
  /** The one whose parameters the what-if has; drawn on top, too. */
  simulated: number | null
  /** Simulates an evaluation; null where nothing can be simulated. */
  onPick: ((evaluation: number) => void) | null
  threshold: number | null
}

interface ParallelProps extends ViewProps {
  height: number
  /** Whether some have no value. */
  none: boolean
}

export function Parallel({ height, none, ...view }: ParallelProps) {
  const { space, kept, ink, worst, over, simulated, onOver, onPick, threshold } = view
  const [holder, width] = useWidth(760)
  const lines = useMemo((): Lines => {
    const bottom = height - 30
    const apart = (width - 2 * SIDE) / Math.max(1, space.axes.length - 1)
    return { xs: space.axes.map((_, k) => SIDE + k * apart), top: TOP, bottom, none: bottom + NONE_BELOW }
  }, [space, width, height])
  const paint = useCallback(
    (ctx: CanvasRenderingContext2D) => paintLines(ctx, space, kept, ink, lines),
    [space, kept, ink, lines],
  )
  const near = ([x, y]: [number, number]) => lineNear(space, kept, lines, x, y)
  const between = useDrag({ onDrag: () => undefined, onClick: (at) => picked(near(at), onPick), onOver: (at) => onOver(at && near(at)) })
  const value = space.axes[0]
  const criterion = value && threshold !== null && threshold >= value.low && threshold <= value.high ? threshold : null
  const x0 = lines.xs[0] ?? 0
  return (
    <div ref={holder}>
      <Layer
        width={width}
        height={height}
        label={`Parallel coordinates of ${kept.length} evaluations: ${space.axes.map((axis) => symbolText(axis.symbol)).join(', ')}`}
        paint={paint}
      >
        <rect className={styles.hit} data-between x={x0} y={TOP} width={(lines.xs.at(-1) ?? x0) - x0} height={lines.none - TOP + 8} {...between} />
        {none && (
          <g pointerEvents="none">
            <path className={figures.a} d={`M${x0 - 5} ${lines.none}h10`} />
            <text x={x0 - 10} y={lines.none + 4} textAnchor="end">
              no value
            </text>
          </g>
        )}
        {worst !== null && <Line space={space} at={worst} lines={lines} stroke="var(--c-worst)" />}
        {simulated !== null && <Line space={space} at={simulated} lines={lines} stroke="var(--c-what-if)" />}
        {over !== null && over !== worst && over !== simulated && <Line space={space} at={over} lines={lines} stroke="var(--ink)" />}
        {space.axes.map((axis, k) => (
          <AxisBar key={axis.key} {...view} axis={axis} lines={lines} x={lines.xs[k] as number} beside={k === 0 && none} />
        ))}
        {value && criterion !== null && <Criterion x={x0} y={lines.bottom - shareOf(value, criterion) * (lines.bottom - TOP)} />}
      </Layer>
    </div>
  )
}

/** Whether an evaluation was met, and is therefore simulated. */
export function picked(met: number | null, onPick: ViewProps['onPick']): boolean {
  if (met === null || !onPick) return false
  onPick(met)
  return true
}

function Criterion({ x, y }: { x: number; y: number }) {
  return (
    <g pointerEvents="none">
      <path className={figures.cr} d={`M${x - 14} ${y}h28`} />
      <text className={clsx(figures.lab, figures.halo)} x={x + 18} y={y + 4}>
        Criterion
      </text>
    </g>
  )
}

function Line({ space, at, lines, stroke }: { space: Space; at: number; lines: Lines; stroke: string }) {
  const path = crossings(space, at, lines)
    .map((y, k) => `${k === 0 ? 'M' : 'L'}${(lines.xs[k] as number).toFixed(1)} ${y.toFixed(1)}`)
    .join('')
  return (
    <g fill="none" pointerEvents="none">
      <path d={path} stroke="var(--surface)" strokeWidth={4} />
      <path d={path} stroke={stroke} strokeWidth={2} />
    </g>
  )
}

interface AxisBarProps extends ViewProps {
  axis: Axis
  lines: Lines
  x: number
  /** Whether the value of the low end is next to the axis. */
  beside: boolean
}

function AxisBar({ space, kept, axis, lines, x, beside, brush, onBrush, onOver, onPick }: AxisBarProps) {
  const { top, bottom } = lines
  const range = brush[axis.key] ?? ([axis.low, axis.high] as const)
  const shown = Boolean(brush[axis.key])
  const yOf = (value: number) => bottom - shareOf(axis, value) * (bottom - top)
  const valueOf = (y: number) => valueAt(axis, (bottom - y) / (bottom - top))
  const grip = useRef<{ part: 0 | 1 | 'all' | 'new'; range: readonly [number, number] }>({ part: 'new', range })
  const [low, high] = [yOf(range[0]), yOf(range[1])]
  const drag = useDrag({
    onStart: ([, y]) => {
      const ends = [Math.abs(y - low), Math.abs(y - high)] as const
      const end = ends[0] <= ends[1] ? 0 : 1
      const part = ends[end] <= HANDLE ? end : shown && y < low && y > high ? 'all' : 'new'
      grip.current = { part, range }
    },
    onDrag: ([, from], [, to]) => {
      const { part, range: before } = grip.current
      if (part === 'new') return onBrush(axis, rangeOn(axis, valueOf(from), valueOf(to)))
      if (part === 'all') {
        const by = ((from - to) / (bottom - top)) * (axis.high - axis.low)
        const fits = Math.min(Math.max(by, axis.low - before[0]), axis.high - before[1])
        return onBrush(axis, rangeOn(axis, before[0] + fits, before[1] + fits))
      }
      onBrush(axis, rangeOn(axis, before[part === 0 ? 1 : 0], valueOf(to)))
    },
    onClick: ([px, py]) => {
      if (!picked(lineNear(space, kept, lines, px, py), onPick)) onBrush(axis, null)
    },
    onOver: (at) => onOver(at && lineNear(space, kept, lines, at[0], at[1])),
  })
  const decimals = decimalsFor([axis.low, axis.high], 3)
  const keyed = (end: 0 | 1) => (event: KeyboardEvent) => {
    const next = nudged(axis, range, end, event.key)
    if (!next) return
    event.preventDefault()
    onBrush(axis, rangeOn(axis, ...next))
  }
  return (
    <g>
      <text x={x} y={14} textAnchor="middle" className={clsx(figures.lab, figures.halo)}>
        <SvgSign text={axis.symbol} />
        {axis.unit && <tspan className={styles.unit}>, {unitText(axis.unit)}</tspan>}
      </text>
      <text x={x} y={30} textAnchor="middle" className={figures.halo}>
        {fixed(axis.high, decimals)}
      </text>
      <text
        x={beside ? x - 10 : x}
        y={bottom + (beside ? 3 : 22)}
        textAnchor={beside ? 'end' : 'middle'}
        className={figures.halo}
      >
        {fixed(axis.low, decimals)}
      </text>
      <path className={figures.a} d={`M${x} ${top}V${bottom}`} />
      {shown && <rect className={styles.brush} x={x - 7} y={high} width={14} height={Math.max(1, low - high)} />}
      <rect data-hit className={styles.hit} x={x - 20} y={top - 8} width={40} height={bottom - top + 16} {...drag}>
        <title>{axis.text}</title>
      </rect>
      {([0, 1] as const).map((end) => (
        <g
          key={end}
          className={styles.handle}
          role="slider"
          tabIndex={0}
          aria-orientation="vertical"
          aria-label={`${symbolText(axis.symbol)}, ${end === 0 ? 'from' : 'to'}`}
          aria-valuemin={axis.low}
          aria-valuemax={axis.high}
          aria-valuenow={range[end]}
          aria-valuetext={`${fixed(range[end], decimals + 1)} ${unitText(axis.unit)}`}
          onKeyDown={keyed(end)}
        >
          <path d={end === 0 ? `M${x - 6} ${low + 1}h12l-6 7z` : `M${x - 6} ${high - 1}h12l-6 -7z`} />
        </g>
      ))}
    </g>
  )
}
