// Several criteria: the Pareto front of the worst cases for two criteria, and its points as a table.
import { clsx } from 'clsx'
import { useMemo, useState } from 'react'
import { resultsWith } from '../../api/stages'
import { ChartCard } from '../../charts/ChartCard'
import { type Key, Legend, useHidden } from '../../charts/Legend'
import { Plot } from '../../charts/Plot'
import type { PlotSpec } from '../../charts/spec'
import { padded } from '../../charts/ticks'
import type { FrontCriterion } from '../../client'
import { count, decimalsFor, exact, fixed } from '../../format/numbers'
import { ofUnit, unitText } from '../../format/units'
import { Seg } from '../../ui/Card'
import { MethodName } from '../../ui/MethodMark'
import { useMethodLook } from '../../ui/methods'
import { Sign, symbolText } from '../../ui/Sign'
import { Table } from '../../ui/Table'
import type { RunData } from '../data/data'
import { parameterColumns } from '../parameters/columns'
import { criteriaOf, frontOf, type Placed, someOf } from './front'
import { layout } from '../../ui/styles'
import runStyles from '../run.module.css'

const ROWS = 12

export function FrontCard({ data }: { data: RunData }) {
  const methodLook = useMethodLook()
  const { run, parameters, stages } = data
  const searches = useMemo(() => resultsWith(stages, 'front'), [stages])
  const criteria = useMemo(() => criteriaOf(searches), [searches])
  const points = useMemo(() => frontOf(searches, criteria), [searches, criteria])
  const [across, setAcross] = useState(criteria[1]?.name ?? '')
  const [up, setUp] = useState(criteria[0]?.name ?? '')
  const [hidden, toggle] = useHidden()
  const x = criteria.find((c) => c.name === across) ?? criteria[1]
  const y = criteria.find((c) => c.name === up) ?? criteria[0]
  const spec = useMemo(
    () => (x && y ? specOf(points, x, y, y === criteria[0] ? run.threshold : null, (method) => methodLook(method).colour) : null),
    [points, x, y, criteria, run.threshold, methodLook],
  )
  if (!x || !y || !spec) return null
  const sizes = searches.map((search) => search.front_size ?? 0)
  const thinned = searches.some((search) => (search.front_size ?? 0) > (search.front?.length ?? 0))
  const keys: Key[] = methodsOf(points).map(([method, label]) => ({ key: method, label, method }))
  const table = () => ({
    name: 'front',
    columns: ['method', 'index', ...criteria.map(headed), ...parameters.map((p) => p.path)],
    rows: points.map((point) => [
      point.title,
      point.index,
      ...criteria.map((c) => point.values[c.name] ?? null),
      ...parameters.map((p) => point.parameters[p.path] ?? null),
    ]),
  })
  const choices = Object.fromEntries(criteria.map((c) => [c.name, c.title]))
  return (
    <ChartCard
      title="Pareto front"
      note={`${count(points.length)} Pareto-optimal evaluations: no other is worse in every criterion`}
      className={layout.c12}
      id="front"
      run={run.id}
      data={table}
      footer={
        <>
          {criteria.map((c) => `${c.title}: ${c.worse === 'high' ? 'more' : 'less'} is worse`).join('; ')}. A search can
          miss points of the Pareto front, and it does not affect the verdict, which rests on {criteria[0]?.title.toLowerCase()} alone.
          {thinned && ` Of the largest of these Pareto fronts, ${count(Math.max(...sizes))} evaluations, some are omitted.`}
        </>
      }
    >
      {criteria.length > 2 && (
        <div className={clsx(layout.row, runStyles.tools)} data-control>
          <div className={clsx(layout.row, runStyles.tool)}>
            <span className="small mut">Vertical</span>
            <Seg label="Vertical axis" options={choices} value={y.name} onChange={setUp} />
          </div>
          <div className={clsx(layout.row, runStyles.tool)}>
            <span className="small mut">Horizontal</span>
            <Seg label="Horizontal axis" options={choices} value={x.name} onChange={setAcross} />
          </div>
        </div>
      )}
      <Plot spec={spec} hidden={hidden} />
      <Legend keys={keys} hidden={hidden} onToggle={toggle} />
      <Points data={data} criteria={criteria} points={points} />
    </ChartCard>
  )
}

const methodsOf = (points: readonly Placed[]) => [...new Map(points.map(({ method, title }) => [method, title]))]

const headed = (c: FrontCriterion): string => `${c.title}${ofUnit(c.unit)}`

function axisTitle(c: FrontCriterion) {
  return (
    <>
      {c.title} <Sign text={c.quantity} />
      {ofUnit(unitText(c.unit))} <span className="mut">({c.worse === 'high' ? 'more' : 'less'} is worse)</span>
    </>
  )
}

function specOf(
  points: readonly Placed[],
  x: FrontCriterion,
  y: FrontCriterion,
  threshold: number | null,
  colourOf: (method: string) => string,
): PlotSpec {
  const valueOf = (point: Placed, c: FrontCriterion): number => point.values[c.name] ?? Number.NaN
  const sorted = [...points].sort((a, b) => valueOf(a, x) - valueOf(b, x))
  const xs = sorted.map((point) => valueOf(point, x))
  const ys = sorted.map((point) => valueOf(point, y))
  const range = padded(ys, 0.06)
  // The axis includes the criterion unless the points would shrink to a line.
  const near = threshold !== null && threshold > range[0] - (range[1] - range[0]) && threshold < range[1] + (range[1] - range[0])
  const [dx, dy] = [decimalsFor(xs, 5), decimalsFor(ys, 5)]
  return {
    label: `Pareto front: ${y.title} over ${x.title}, ${points.length} evaluations`,
    x: xs,
    lines: methodsOf(points).map(([method, label]) => ({
      key: method,
      label,
      colour: colourOf(method),
      y: sorted.map((point, i) => (point.method === method ? (ys[i] as number) : null)),
      dots: true,
    })),
    xTitle: axisTitle(x),
    yTitle: axisTitle(y),
    xRange: padded(xs, 0.04),
    yRange: near ? padded([...ys, threshold], 0.06) : range,
    criterion: near ? { value: threshold, label: `Criterion, ${exact(threshold)} ${y.unit}`, tint: true, right: true } : undefined,
    height: 300,
    xText: (v) => `${symbolText(x.quantity || x.title)} = ${fixed(v, dx)} ${unitText(x.unit)}`,
    yText: (v) => `${symbolText(y.quantity || y.title)} = ${fixed(v, dy)} ${unitText(y.unit)}`,
  }
}

interface PointsProps {
  data: RunData
  criteria: readonly FrontCriterion[]
  points: readonly Placed[]
}

function Points({ data, criteria, points }: PointsProps) {
  const rows = someOf(points, ROWS)
  const digits = new Map(criteria.map((c) => [c.name, decimalsFor(points.map((p) => p.values[c.name] ?? null), 5)]))
  return (
    <>
      <div className={layout.scrollx} tabIndex={0} role="region" aria-label="Points of the Pareto front">
        <Table
          tight
          rows={rows}
          columns={[
            { head: 'Found by', cell: ({ method, title }) => <MethodName method={method} title={title} /> },
            ...criteria.map(({ name, title, unit }) => ({
              head: title,
              unit: unitText(unit),
              cell: ({ values }: Placed) => fixed(values[name], digits.get(name) ?? 3),
            })),
            ...parameterColumns<Placed>(data.parameters, (point, p) => fixed(point.parameters[p.path], decimalsFor([p.low, p.high])), undefined, 'sec'),
            { head: 'Index', num: true, tone: 'sec', cell: ({ index }) => count(index) },
          ]}
        />
      </div>
      {rows.length < points.length && (
        <p className="small mut">
          {rows.length} of {count(points.length)}, spread over {criteria[0]?.title.toLowerCase()}; all of them are in the
          data and the CSV file.
        </p>
      )}
    </>
  )
}
