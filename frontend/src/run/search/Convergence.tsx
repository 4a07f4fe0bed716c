// Convergence history: the best value of each method so far over evaluations or working time, live and afterwards.
import { clsx } from 'clsx'
import { useMemo, useState } from 'react'
import { ChartCard } from '../../charts/ChartCard'
import { type Key, Legend, useHidden } from '../../charts/Legend'
import { Plot } from '../../charts/Plot'
import { useReach } from '../../charts/reach'
import { stepsOn, union } from '../../charts/series'
import type { PlotSpec } from '../../charts/spec'
import { count, decimalsApart, decimalsFor, fixed, plain } from '../../format/numbers'
import { ofUnit } from '../../format/units'
import { Seg } from '../../ui/Card'
import { useMethodLook } from '../../ui/methods'
import { Sign, symbolText } from '../../ui/Sign'
import { convergenceOf, type RunData, searchesOf } from '../data/data'
import { insteadOf } from '../data/missing'
import { layout } from '../../ui/styles'
import runStyles from '../run.module.css'

interface ConvergenceProps {
  data: RunData
  className?: string
  height: number
}

export function Convergence({ data, className, height }: ConvergenceProps) {
  const methodLook = useMethodLook()
  const { run } = data
  const [by, setBy] = useState<'evaluations' | 'seconds'>('evaluations')
  const [scale, setScale] = useState<'log' | 'linear'>('log')
  const [hidden, toggle] = useHidden()
  const { stages, evaluations, catalogue } = data
  const searches = useMemo(
    () => searchesOf({ run, stages, evaluations, catalogue }),
    [run, stages, evaluations, catalogue],
  )
  const log = by === 'evaluations' && scale === 'log'

  const curves = useMemo(
    () =>
      searches
        .map((search) => ({ search, curve: convergenceOf(search, by) }))
        .filter(({ curve }) => curve.x.length > 0),
    [searches, by],
  )
  const { criterion, choice, note } = useReach(
    curves.flatMap(({ curve }) => curve.y),
    run.threshold,
    run.unit,
    'this axis',
  )
  const spec = useMemo((): PlotSpec => {
    const xs = union(curves.map(({ curve }) => curve))
    const values = curves.flatMap(({ curve }) => curve.y)
    const decimals = decimalsFor(values, 5)
    return {
      label: `Convergence: best ${symbolText(run.quantity || 'value')} found so far by ${curves.length} methods`,
      x: xs,
      lines: curves.map(({ search, curve }) => ({
        key: String(search.stage.position),
        label: search.title,
        colour: methodLook(search.stage.method).colour,
        y: stepsOn(xs, curve),
        stepped: true,
        width: 1.7,
        end: methodLook(search.stage.method).shape,
      })),
      yTitle: (
        <>
          Best <Sign text={run.quantity || 'value'} /> so far{ofUnit(run.unit)}
        </>
      ),
      xTitle:
        by === 'evaluations'
          ? `Evaluations of each method${log ? ' (log scale)' : ''}`
          : 'Working time of each method, s',
      xLog: log,
      criterion:
        criterion === null
          ? undefined
          : { value: criterion, label: `Criterion, ${plain(criterion)} ${run.unit}`, tint: true },
      height,
      xText: (x) => (by === 'evaluations' ? `Evaluation ${count(x)}` : `${fixed(x, 3)} s`),
      yText: (y) => `${fixed(y, decimals)} ${run.unit}`,
    }
  }, [curves, criterion, run.quantity, run.unit, by, log, height, methodLook])

  const keys: Key[] = curves.map(({ search }) => ({
    key: String(search.stage.position),
    label: search.title,
    method: search.stage.method ?? '',
  }))
  const table = () => ({
    name: 'convergence',
    columns: ['method', 'evaluation', 'working time, s', `best ${run.quantity || 'value'} so far${ofUnit(run.unit)}`],
    rows: searches.flatMap(({ series, stage, title }) =>
      (series?.improvements.index ?? []).map((at, i) => [
        title || stage.method,
        at + 1,
        series?.improvements.seconds?.[i] ?? null,
        series?.improvements.cost?.[i] ?? null,
      ]),
    ),
  })
  return (
    <ChartCard
      title="Convergence"
      note="Smallest value found by each method"
      className={className}
      run={run.id}
      data={table}
    >
      <div className={clsx(layout.row, runStyles.tools)} data-control>
        {choice}
        {by === 'evaluations' && (
          <Seg label="Scale of evaluations" options={{ log: 'Log', linear: 'Linear' }} value={scale} onChange={setScale} />
        )}
        <Seg label="Horizontal axis" options={{ evaluations: 'Evaluations', seconds: 'Time' }} value={by} onChange={setBy} />
      </div>
      {curves.length === 0 ? (
        <p className="sec" style={{ minHeight: height }}>
          {data.evaluations ? 'No search has completed an evaluation yet.' : insteadOf(data.missing, 'evaluations')}
        </p>
      ) : (
        <>
          <Plot spec={spec} hidden={hidden} />
          <Legend keys={keys} hidden={hidden} onToggle={toggle} />
          {note}
          <p className="sr">
            {curves
              .map(
                ({ search, curve }) =>
                  `${search.title}: ${fixed(Math.min(...curve.y), decimalsApart(curve.y))} ${run.unit}`,
              )
              .join('; ')}
          </p>
        </>
      )}
    </ChartCard>
  )
}
