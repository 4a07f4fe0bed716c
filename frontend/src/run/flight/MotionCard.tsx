// Speeds and commands over time, one small chart each: nominal and chosen flight, with the crosshair of the separation
// chart. The selected columns are in the address.
import { IconAdjustmentsHorizontal } from '@tabler/icons-react'
import { useMemo } from 'react'
import { ChartCard } from '../../charts/ChartCard'
import { Legend, useHidden } from '../../charts/Legend'
import { Plot, type Standing } from '../../charts/Plot'
import { linesOn, union } from '../../charts/series'
import type { PlotSpec } from '../../charts/spec'
import { padded } from '../../charts/ticks'
import { hasScenario } from '../../api/campaign'
import type { FlightAnswer, TraceColumn } from '../../client'
import { decimalsFor, fixed, short } from '../../format/numbers'
import { unitText } from '../../format/units'
import { Button } from '../../ui/Button'
import { Menu, Pick, Picks } from '../../overlay/Menu'
import { Sign, symbolText } from '../../ui/Sign'
import { useWidth } from '../../ui/useWidth'
import type { RunData } from '../data/data'
import {
  acrossOf,
  curveOf,
  extentOf,
  MOST_COLUMNS,
  overTime,
  shownColumns,
  spanOf,
  TIME,
  wordsOf,
} from './flown'
import { type Flown, flownOf, useShown, whatIfOf } from './SeparationCard'
import { useAddress } from '../data/useAddress'
import { layout } from '../../ui/styles'
import styles from './flight.module.css'

/** Minimum width of a chart [px]. */
const LEAST = 200
/** Between charts: the values of one must not run into the name of the next [px]. */
const GAP = 24

interface MotionProps {
  data: RunData
  /** Called with the time under the pointer [s], which the 3D view shows. */
  onCross: (time: number) => void
  /** The result of the open what-if of a simulator. */
  whatIf?: FlightAnswer | null
  /** The displayed time: position of the crosshair while no pointer is on a chart. */
  standing: Standing
}

export function MotionCard({ data, onCross, standing, whatIf = null }: MotionProps) {
  const { run, nominalTrace, findingTrace, chosen } = data
  const [address, change] = useAddress(run.id)
  const [shown] = useShown(run.id)
  const flies = hasScenario(data.campaign)
  const [hidden, toggle] = useHidden()
  const [holder, width] = useWidth(540)
  const flights = useMemo(
    () => [...flownOf({ nominalTrace, findingTrace, chosen, run }), ...whatIfOf(whatIf)],
    [nominalTrace, findingTrace, chosen, run, whatIf],
  )
  const all = useMemo(() => overTime(flights[0]?.trace), [flights])
  const columns = useMemo(() => shownColumns(all, address.columns), [all, address.columns])
  const span = useMemo(
    () =>
      spanOf(
        flights.map(({ trace }) => trace),
        run.threshold,
        flies ? shown : 'all',
      ),
    [flights, run.threshold, shown, flies],
  )
  if (all.length === 0) return null
  const across = acrossOf(columns.length, Math.max(1, Math.floor((width + GAP) / (LEAST + GAP))))
  return (
    <ChartCard
      title={flies ? 'Speeds and commands' : 'Trace over time'}
      note={columns.length < all.length ? `${columns.length} of ${all.length}` : undefined}
      run={run.id}
      data={() => tableOf(columns, flights, flies ? 'speeds-and-commands' : 'trace')}
      footer={flies ? FOOTER : <Called data={data} flights={flights} />}
      right={
        <>
          <Legend keys={flights} hidden={hidden} onToggle={toggle} />
          {all.length > MOST_COLUMNS && (
            <Choice all={all} shown={columns} chosen={address.columns !== undefined} onChange={(columns) => change({ columns })} />
          )}
        </>
      }
    >
      <div ref={holder}>
        <div className={styles.motion} style={{ gridTemplateColumns: `repeat(${across}, minmax(0, 1fr))` }}>
          {columns.map((column, i) => (
            <Small
              key={column.name}
              column={column}
              flights={flights}
              span={span}
              hidden={hidden}
              onCross={onCross}
              standing={standing}
              last={i + across >= columns.length}
            />
          ))}
        </div>
      </div>
    </ChartCard>
  )
}

interface SmallProps extends Pick<MotionProps, 'onCross' | 'standing'> {
  column: TraceColumn
  flights: readonly Flown[]
  span: [number, number]
  hidden: ReadonlySet<string>
  /** Whether it is in the last row, which has the axis title. */
  last: boolean
}

function Small({ column, flights, span, hidden, onCross, standing, last }: SmallProps) {
  const spec = useMemo((): PlotSpec => {
    const { name, symbol } = column
    const statement = wordsOf(column)
    const unit = unitText(column.unit)
    const drawn = flights.map((flown) => ({ ...flown, curve: curveOf(flown.trace, name) }))
    const xs = union(drawn.map(({ curve }) => curve))
    const extent = extentOf(
      drawn.map(({ curve }) => curve),
      span,
    )
    const decimals = decimalsFor(extent ?? [1], 3)
    const near = drawn.flatMap(({ key, colour, trace, curve }) => {
      const time = trace.meta.closest?.time
      const value = time === undefined ? null : (linesOn([time], curve)[0] ?? null)
      return time === undefined ? [] : [{ key, colour, time, value }]
    })
    return {
      label: `${statement || symbolText(symbol)} over time, ${flights.map(({ label }) => label.toLowerCase()).join(' and ')}${column.group === 'signal' ? '' : ' flight'}`,
      x: xs,
      lines: drawn.map(({ key, label, colour, curve }) => ({ key, label, colour, y: linesOn(xs, curve), width: 1.5 })),
      points: near.flatMap(({ key, colour, time, value }) => (value === null ? [] : [{ x: time, y: value, colour, line: key }])),
      rules: near.map(({ time, colour }) => ({ x: time, colour })),
      yTitle: (
        <>
          <b>
            <Sign text={symbol} />
          </b>
          <span className="mut">
            {statement && ` ${statement}`}
            {unit && `, ${unit}`}
          </span>
        </>
      ),
      xTitle: last ? 'Time since start, s' : undefined,
      xRange: span,
      yRange: padded(extent ?? [0, 1], 0.08),
      yTicks: 3,
      left: 46,
      height: 96,
      sync: TIME,
      readout: true,
      xText: (x) => `${fixed(x, 2)} s`,
      yText: (y) => short(y, decimals),
    }
  }, [column, flights, span, last])
  return <Plot spec={spec} hidden={hidden} onCross={onCross} standing={standing} />
}

interface ChoiceProps {
  all: readonly TraceColumn[]
  shown: readonly TraceColumn[]
  chosen: boolean
  onChange: (columns: string | undefined) => void
}

function Choice({ all, shown, chosen, onChange }: ChoiceProps) {
  const names = shown.map(({ name }) => name)
  const toggle = (name: string, on: boolean) =>
    onChange(all.map((column) => column.name).filter((each) => (each === name ? on : names.includes(each))).join(',') || undefined)
  return (
    <Menu name="Columns" value={null} on={chosen} icon={<IconAdjustmentsHorizontal className="i" aria-hidden />}>
      <Picks label="Columns over time">
        {all.map((column) => (
          <Pick key={column.name} on={names.includes(column.name)} onChange={(on) => toggle(column.name, on)}>
            <span className={layout.grow}>
              <Sign text={column.symbol} /> <span className="mut">{wordsOf(column)}</span>
            </span>
            <span className="mut">{unitText(column.unit)}</span>
          </Pick>
        ))}
      </Picks>
      <span className={layout.row}>
        <Button small onClick={() => onChange(all.map(({ name }) => name).join(','))}>All</Button>
        {chosen && (
          <Button small onClick={() => onChange(undefined)}>Default columns</Button>
        )}
      </span>
    </Menu>
  )
}

const FOOTER =
  'Dotted: the closest approaches. Values under the crosshair are next to each name; the separation chart shares the crosshair.'

/** What the traces of a simulator show: the stored evaluation, or one more call with a value of its own. */
function Called({ data, flights }: { data: RunData; flights: readonly Flown[] }) {
  const { run, finding } = data
  const others = flights.filter(({ key }) => key !== 'what-if').flatMap(({ key, label, trace }) => {
    const stored = key === 'nominal' ? run.nominal_cost : (finding?.cost ?? null)
    const { cost } = trace.meta
    return cost === stored || cost === null ? [] : [`${label} ${fixed(cost, decimalsFor([cost, stored]))} ${run.unit}`]
  })
  if (others.length === 0) return <>As the simulator returned them, in evaluations with the stored values.</>
  return <>As the simulator returned them. They show one more call each, with its own value: {others.join(', ')}.</>
}

function tableOf(columns: readonly TraceColumn[], flights: readonly Flown[], name: string) {
  const curves = columns.flatMap((column) =>
    flights.map(({ label, trace }) => ({
      head: `${symbolText(column.symbol)} ${label.toLowerCase()}${column.unit && `, ${unitText(column.unit)}`}`,
      curve: curveOf(trace, column.name),
    })),
  )
  const xs = union(curves.map(({ curve }) => curve))
  const values = curves.map(({ curve }) => linesOn(xs, curve))
  return {
    name,
    columns: ['time since start, s', ...curves.map(({ head }) => head)],
    rows: xs.map((x, i) => [x, ...values.map((column) => column[i] ?? null)]),
  }
}
