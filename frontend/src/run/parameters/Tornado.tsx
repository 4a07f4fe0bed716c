// Tornado chart: change of the value from nominal at the low and the high bound of each parameter.

import type { SlicesResult } from '../../api/stages'
import { TicksBelow } from '../../charts/axes'
import { ChartCard } from '../../charts/ChartCard'
import { linearTicks, tickText } from '../../charts/ticks'
import { decimalsFor, fixed, signed } from '../../format/numbers'
import { ofUnit } from '../../format/units'
import { Sign, SvgSign } from '../../ui/Sign'
import { useWidth } from '../../ui/useWidth'
import type { RunData } from '../data/data'
import { figures } from '../../ui/styles'

interface Bar {
  path: string
  symbol: string
  low: number
  high: number
}

interface TornadoProps {
  data: RunData
  result: SlicesResult
  className?: string
  /** More spacing between rows, next to higher cards. */
  tall?: boolean
}

export function Tornado({ data, result, className, tall }: TornadoProps) {
  const { run } = data
  const bars = barsOf(data, result)
  const decimals = decimalsFor([run.nominal_cost], 4)
  const table = () => ({
    name: 'tornado',
    columns: ['parameter', `change at low bound${ofUnit(run.unit)}`, `change at high bound${ofUnit(run.unit)}`],
    rows: bars.map((bar) => [bar.path, bar.low, bar.high]),
  })
  const most = bars[0]
  return (
    <ChartCard
      title="Tornado"
      note={run.nominal_cost === null ? undefined : `From nominal ${fixed(run.nominal_cost, decimals)} ${run.unit}`}
      className={className}
      run={run.id}
      data={table}
      footer={
        most && (
          <>
            {bars.length < result.curves.length && 'Parameters without a value at one of their bounds are omitted. '}
            <Sign text={most.symbol} path={most.path} /> {movedBy(most, run.unit)}
          </>
        )
      }
    >
      {bars.length > 0 ? (
        <Bars bars={bars} quantity={run.quantity || 'value'} unit={run.unit} row={tall ? 52 : 36} />
      ) : (
        <p className="sec">No parameter has a value at both of its bounds.</p>
      )}
    </ChartCard>
  )
}

/** How far a parameter moves the value; without a worse side if both of its bounds are better than nominal. */
export function movedBy({ low, high }: Pick<Bar, 'low' | 'high'>, unit: string): string {
  const [least, most] = [Math.min(low, high), Math.max(low, high)]
  const by = (change: number) => `${signed(change, decimalsFor([low, high], 2))} ${unit}`
  return least < 0 && 0.1 * most > -least
    ? `has the largest effect: ${by(most)} at one bound, ${signed(least, decimalsFor([least], 1))} ${unit} at the other.`
    : least < 0 ? `has the largest effect: ${by(least)} at its worse bound.` : `has the largest effect: up to ${by(most)}; neither bound is worse than nominal.`
}

function barsOf({ run, parameters }: RunData, result: SlicesResult): Bar[] {
  const nominal = run.nominal_cost
  if (nominal === null) return []
  return result.curves
    .flatMap((curve) => {
      const low = curve.costs[0]
      const high = curve.costs[curve.costs.length - 1]
      if (typeof low !== 'number' || typeof high !== 'number') return []
      const symbol = parameters.find((p) => p.path === curve.path)?.symbol ?? curve.path
      return [{ path: curve.path, symbol, low: low - nominal, high: high - nominal }]
    })
    .sort((a, b) => reach(b) - reach(a))
}

const reach = (bar: Bar): number => Math.max(Math.abs(bar.low), Math.abs(bar.high))
const [BAR, SIGN, SIDE] = [16, 46, 34]
/** Width of the labels: symbols are short, names with a part and paths are not. */
const leftOf = (bars: Bar[]): number => Math.max(SIGN, ...bars.map(({ symbol }) => (/[. ]/.test(symbol) ? 12 + 6.4 * symbol.length : 0)))

function Bars({ bars, quantity, unit, row }: { bars: Bar[]; quantity: string; unit: string; row: number }) {
  const left = leftOf(bars)
  const [holder, width] = useWidth(340)
  const most = Math.max(...bars.map(reach), 1e-12)
  const plot = width - left - 2 * SIDE
  const x = (change: number) => left + SIDE + plot / 2 + (change / most) * (plot / 2)
  const right = linearTicks(0, most, 2).filter((tick) => tick > 0)
  const ticks = [...right.map((tick) => -tick).reverse(), 0, ...right]
  const text = tickText(ticks)
  const bottom = bars.length * row + 6
  return (
    <div ref={holder}>
      <svg
        className={figures.ch}
        height={bottom + 40}
        role="img"
        aria-label={`Change of ${quantity} at the bounds of each parameter`}
      >
        <TicksBelow ticks={ticks} at={x} text={(tick) => (tick > 0 ? `+${text(tick)}` : text(tick))} foot={bottom} top={0} />
        {bars.map((bar, i) => {
          const y = i * row + (row - 20) / 2
          return (
            <g key={bar.path}>
              <text x={4} y={y + 12} className={figures.lab}>
                <SvgSign text={bar.symbol} />
              </text>
              <Half bar={bar} side="low" x={x} y={y} />
              <Half bar={bar} side="high" x={x} y={y} />
            </g>
          )
        })}
        <path className={figures.a} d={`M${x(0)} 0V${bottom}`} style={{ stroke: 'var(--ink)' }} strokeWidth={1.5} />
        <text x={left + SIDE + plot / 2} y={bottom + 34} textAnchor="middle">
          Change of <SvgSign text={quantity || 'value'} />{ofUnit(unit)}
        </text>
      </svg>
    </div>
  )
}

interface HalfProps {
  bar: Bar
  side: 'low' | 'high'
  x: (change: number) => number
  y: number
}

/** The bar of one bound, labelled at its end; if both have the same direction, the second is drawn inside. */
function Half({ bar, side, x, y }: HalfProps) {
  const change = bar[side]
  const same = Math.sign(bar.low) === Math.sign(bar.high)
  const inner = same && Math.abs(change) < reach(bar)
  const down = change < 0
  return (
    <>
      <rect
        x={Math.min(x(0), x(change))}
        y={inner ? y + BAR * 0.25 : y}
        width={Math.max(1, Math.abs(x(change) - x(0)))}
        height={inner ? BAR * 0.5 : BAR}
        fill={down ? 'var(--c-worst)' : 'var(--c-nom)'}
        fillOpacity={down ? 1 : 0.55}
        stroke={inner ? 'var(--surface)' : 'none'}
      />
      {!inner && (
        <text x={x(change) + (down ? -5 : 5)} y={y + 12} textAnchor={down ? 'end' : 'start'}>
          {side}
        </text>
      )}
    </>
  )
}
