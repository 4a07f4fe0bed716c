// Evaluations over pairs of axes: all pairs of few parameters, or one chosen pair of many.
// A rectangle drawn in a cell is a range on both of its axes.
import { clsx } from 'clsx'
import { useCallback, useMemo } from 'react'
import { linearTicks, tickText } from '../../charts/ticks'
import { unitText } from '../../format/units'
import { symbolText, SvgSign } from '../../ui/Sign'
import { useWidth } from '../../ui/useWidth'
import { Layer } from './Layer'
import { type Cell, paintPoints, placed, pointNear } from './paint'
import { picked, type ViewProps } from './Parallel'
import { type Axis, parametersOf, rangeOn, shareOf, type Space, valueAt } from './space'
import { useDrag } from './useDrag'
import { figures } from '../../ui/styles'
import styles from './space.module.css'

const [LEFT, BOTTOM, TOP, RIGHT, GAP] = [62, 40, 8, 10, 14]

interface ScatterProps extends ViewProps {
  height: number
  /** Indices of the axes, horizontal and vertical. All pairs if absent. */
  pair: readonly [number, number] | null
}

export function Scatter({ height, pair, ...view }: ScatterProps) {
  const { space, kept, ink, worst, over, simulated } = view
  const [holder, width] = useWidth(520)
  const cells = useMemo(
    () => (pair ? [cellOf(pair, width, height)] : matrixOf(space, ink.axis, width, height)),
    [space, ink.axis, pair, width, height],
  )
  const paint = useCallback(
    (ctx: CanvasRenderingContext2D) => paintPoints(ctx, space, kept, ink, cells),
    [space, kept, ink, cells],
  )
  return (
    <div ref={holder}>
      <Layer
        width={width}
        height={height}
        label={`Scatter of ${kept.length} evaluations: ${cells.map((cell) => pairText(space, cell)).join('; ')}`}
        paint={paint}
      >
        {cells.map((cell) => (
          <Frame key={`${cell.x} ${cell.y}`} cell={cell} cells={cells} {...view} />
        ))}
        {cells.map((cell) => (
          <g key={`${cell.x} ${cell.y}`} pointerEvents="none">
            {worst !== null && <Ring space={space} at={worst} cell={cell} stroke="var(--c-worst)" />}
            {simulated !== null && <Ring space={space} at={simulated} cell={cell} stroke="var(--c-what-if)" />}
            {over !== null && over !== worst && over !== simulated && <Ring space={space} at={over} cell={cell} stroke="var(--ink)" />}
          </g>
        ))}
      </Layer>
    </div>
  )
}

const pairText = ({ axes }: Space, { x, y }: Cell): string =>
  `${symbolText(axes[y]?.symbol ?? '')} over ${symbolText(axes[x]?.symbol ?? '')}`

const cellOf = ([x, y]: readonly [number, number], width: number, height: number): Cell => ({
  x,
  y,
  left: LEFT,
  top: TOP,
  width: width - LEFT - RIGHT,
  height: height - TOP - BOTTOM,
})

/** The lower triangle of all pairs in parameter order, with the coloured quantity in the last row. */
function matrixOf({ axes }: Space, last: number, width: number, height: number): Cell[] {
  const order = [...parametersOf(axes), last]
  const across = order.length - 1
  const w = (width - LEFT - RIGHT - GAP * (across - 1)) / across
  const h = (height - TOP - BOTTOM - GAP * (across - 1)) / across
  return order.slice(1).flatMap((y, row) =>
    order.slice(0, row + 1).map((x, column) => ({
      x,
      y,
      left: LEFT + column * (w + GAP),
      top: TOP + row * (h + GAP),
      width: w,
      height: h,
    })),
  )
}

function Ring({ space, at, cell, stroke }: { space: Space; at: number; cell: Cell; stroke: string }) {
  const [cx, cy] = placed(space, at, cell)
  if (Number.isNaN(cx + cy)) return null
  return (
    <g fill="none">
      <circle cx={cx} cy={cy} r={5} stroke="var(--surface)" strokeWidth={4} />
      <circle cx={cx} cy={cy} r={5} stroke={stroke} strokeWidth={2} />
    </g>
  )
}

interface FrameProps extends ViewProps {
  cell: Cell
  cells: readonly Cell[]
}

function Frame({ cell, cells, space, kept, brush, onBrush, onOver, onPick, threshold }: FrameProps) {
  const across = space.axes[cell.x] as Axis
  const up = space.axes[cell.y] as Axis
  const { left, top, width, height } = cell
  const [right, bottom] = [left + width, top + height]
  const drag = useDrag({
    onDrag: (from, to) => {
      const x = (px: number) => valueAt(across, (px - left) / width)
      const y = (py: number) => valueAt(up, (bottom - py) / height)
      onBrush(across, rangeOn(across, x(from[0]), x(to[0])))
      onBrush(up, rangeOn(up, y(from[1]), y(to[1])))
    },
    onClick: ([x, y]) => {
      if (picked(pointNear(space, kept, cell, x, y), onPick)) return
      onBrush(across, null)
      onBrush(up, null)
    },
    onOver: (at) => onOver(at && pointNear(space, kept, cell, at[0], at[1])),
  })
  const first = !cells.some((other) => other.y === cell.y && other.left < left)
  const last = !cells.some((other) => other.x === cell.x && other.top > top)
  const [rx, ry] = [brush[across.key], brush[up.key]]
  const xOf = (value: number) => left + shareOf(across, value) * width
  const yOf = (value: number) => bottom - shareOf(up, value) * height
  const level = cell.y === 0 && threshold !== null && threshold >= up.low && threshold <= up.high ? yOf(threshold) : null
  return (
    <g>
      <path className={figures.a} d={`M${left} ${top}V${bottom}H${right}`} />
      {first && <Upright axis={up} cell={cell} />}
      {last && <Level axis={across} cell={cell} />}
      {level !== null && <path className={figures.cr} d={`M${left} ${level}H${right}`} />}
      {level !== null && first && width > 160 && (
        <text className={clsx(figures.lab, figures.halo)} x={left + 4} y={level - 5}>
          Criterion
        </text>
      )}
      {(rx ?? ry) && (
        <rect
          className={styles.brush}
          x={rx ? xOf(rx[0]) : left}
          y={ry ? yOf(ry[1]) : top}
          width={rx ? Math.max(1, xOf(rx[1]) - xOf(rx[0])) : width}
          height={ry ? Math.max(1, yOf(ry[0]) - yOf(ry[1])) : height}
        />
      )}
      <rect data-hit className={styles.hit} x={left} y={top} width={width} height={height} {...drag} />
    </g>
  )
}

/** At least two ticks, to show the scale of an axis. */
function ticksOf({ low, high }: Axis, room: number, each: number): number[] {
  const ticks = linearTicks(low, high, Math.max(2, Math.floor(room / each)))
  return ticks.length > 1 ? ticks : linearTicks(low, high, 4)
}

function Upright({ axis, cell }: { axis: Axis; cell: Cell }) {
  const ticks = ticksOf(axis, cell.height, 40)
  const text = tickText(ticks)
  const middle = cell.top + cell.height / 2
  return (
    <g>
      {ticks.map((tick) => (
        <text key={tick} x={cell.left - 6} y={cell.top + (1 - shareOf(axis, tick)) * cell.height + 4} textAnchor="end">
          {text(tick)}
        </text>
      ))}
      <Title axis={axis} x={11} y={middle} turned />
    </g>
  )
}

/** Labels at the ends of an axis stay within it, next to those of the next cell. */
const anchorAt = (share: number) => (share < 0.04 ? 'start' : share > 0.96 ? 'end' : 'middle')

function Level({ axis, cell }: { axis: Axis; cell: Cell }) {
  const ticks = ticksOf(axis, cell.width, 70)
  const text = tickText(ticks)
  const bottom = cell.top + cell.height
  return (
    <g>
      {ticks.map((tick) => (
        <text
          key={tick}
          x={cell.left + shareOf(axis, tick) * cell.width}
          y={bottom + 15}
          textAnchor={anchorAt(shareOf(axis, tick))}
        >
          {text(tick)}
        </text>
      ))}
      <Title axis={axis} x={cell.left + cell.width / 2} y={bottom + 32} />
    </g>
  )
}

function Title({ axis, x, y, turned }: { axis: Axis; x: number; y: number; turned?: boolean }) {
  return (
    <text x={x} y={y} textAnchor="middle" className={figures.lab} transform={turned ? `rotate(-90 ${x} ${y})` : undefined}>
      <SvgSign text={axis.symbol} />
      {axis.unit && <tspan className={styles.unit}>, {unitText(axis.unit)}</tspan>}
    </text>
  )
}
