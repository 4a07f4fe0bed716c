// The independent sample: its histogram with criterion, nominal and worst, its distribution function if the certify
// stage drew it, and the statements that it supports.

import { clsx } from 'clsx'
import { useState } from 'react'
import type { Blocks, GridResult, Sample } from '../../client'
import { sampleTitle } from '../../api/stages'
import { AxisBelow, TicksBeside } from '../../charts/axes'
import { ChartCard } from '../../charts/ChartCard'
import { linearTicks, tickDecimals } from '../../charts/ticks'
import { lostOf } from '../../format/counts'
import { ofUnit } from '../../format/units'
import { count, decimalsFor, exact, fixed, plain, short } from '../../format/numbers'
import { sentence, words } from '../../format/spans'
import { Seg } from '../../ui/Card'
import { Spans } from '../../ui/Spans'
import { SvgSign, symbolText } from '../../ui/Sign'
import { useWidth } from '../../ui/useWidth'
import { DistributionCurve } from './DistributionCurve'
import type { RunData } from '../data/data'
import { figures } from '../../ui/styles'

interface SampleCardProps {
  data: RunData
  sample: Sample
  /** Simulated by the certify stage in addition to the sample. */
  grid?: GridResult | null
  blocks?: Blocks | null
}

export function SampleCard({ data, sample, grid, blocks }: SampleCardProps) {
  const { run } = data
  const [shape, setShape] = useState<'bars' | 'curve'>('bars')
  const { distribution, quantile } = sample
  const drawn = distribution && distribution.values.length > 1 ? distribution : null
  const decimals = decimalsFor([sample.mean, sample.lowest], 5)
  const edges = sample.histogram?.edges ?? []
  const table = () => ({
    name: 'sample',
    columns: [`from${ofUnit(run.unit)}`, `to${ofUnit(run.unit)}`, 'samples'],
    rows: (sample.histogram?.counts ?? []).map((n, i) => [edges[i] ?? null, edges[i + 1] ?? null, n]),
  })
  return (
    <ChartCard
      title={sampleTitle(data.stages, sample)}
      note={`${count(sample.samples)} samples from the stated distributions${lostOf(sample)}`}
      id="sample"
      run={run.id}
      data={table}
      right={
        drawn && (
          <Seg label="Shape" options={{ bars: 'Histogram', curve: 'Distribution' }} value={shape} onChange={setShape} />
        )
      }
      footer={
        <>
          Mean {fixed(sample.mean, decimals)} {run.unit}, standard deviation {plain(sample.deviation, 3)} {run.unit},
          lowest {fixed(sample.lowest, decimals)} {run.unit}. <Spans spans={sentence(sample.statement)} />
          {quantile && (
            <span title={quantile.order ? `Value number ${count(quantile.order)} of ${count(sample.samples)}, from the lowest` : undefined}>
              <Spans spans={[words(' '), ...sentence(quantile.statement)]} />
            </span>
          )}
          {blocks && <Spans spans={[words(' '), ...sentence(blocks.statement)]} />}
          {grid && <Spans spans={[words(' '), ...sentence(grid.statement)]} />}
        </>
      }
    >
      {drawn && shape === 'curve' ? (
        <DistributionCurve data={data} sample={{ ...sample, distribution: drawn }} height={HEIGHT} />
      ) : sample.histogram && sample.histogram.counts.length > 0 ? (
        <Histogram data={data} edges={edges} counts={sample.histogram.counts} />
      ) : (
        <p className="sec">No evaluation of the sample has a value.</p>
      )}
    </ChartCard>
  )
}

const [HEIGHT, TOP, LEFT, BOTTOM, RIGHT] = [250, 56, 40, 36, 12]

function Histogram({ data, edges, counts }: { data: RunData; edges: number[]; counts: number[] }) {
  const { run } = data
  const [holder, width] = useWidth(420)
  const [first, last] = [edges[0] ?? 0, edges[edges.length - 1] ?? 1]
  const spread = last - first || 1
  // The axis includes the criterion unless the bars would shrink to a line.
  const threshold = run.threshold
  const off = threshold === null || threshold < first - 2 * spread || threshold > last + 2 * spread
  const low = Math.min(first, run.worst_cost ?? first, off ? first : threshold) - 0.04 * spread
  const high = Math.max(last, run.nominal_cost ?? last, off ? last : threshold) + 0.04 * spread
  const most = Math.max(...counts)
  const x = (v: number) => LEFT + ((width - LEFT - RIGHT) * (v - low)) / (high - low)
  const y = (n: number) => HEIGHT - BOTTOM - ((HEIGHT - BOTTOM - TOP) * n) / most
  const xs = linearTicks(low, high, Math.max(3, width / 100))
  const ys = linearTicks(0, most, 4)
  const decimals = tickDecimals(xs)
  const written = (value: number | null) => `${fixed(value, decimalsFor([value]))} ${run.unit}`
  const marks = [
    { value: off ? null : threshold, text: `Criterion ${exact(threshold)} ${run.unit}`, colour: 'var(--c-crit)', dashed: true },
    { value: run.worst_cost, text: `Worst ${written(run.worst_cost)}`, colour: 'var(--c-worst)' },
    { value: run.nominal_cost, text: `Nominal ${written(run.nominal_cost)}`, colour: 'var(--ink-2)' },
  ]
  return (
    <div ref={holder}>
      <div className="sec micro">
        Samples per {plain(spread / counts.length, 2)} {run.unit} bin
      </div>
      <svg
        className={figures.ch}
        height={HEIGHT}
        role="img"
        aria-label={`Histogram of ${symbolText(run.quantity || 'value')} over the sample`}
      >
        <TicksBeside ticks={ys} at={y} text={count} from={LEFT} to={width - RIGHT} />
        {counts.map((n, i) => {
          const [from, to] = [edges[i] ?? 0, edges[i + 1] ?? 0]
          const violates = threshold !== null && to <= threshold
          return (
            <rect
              key={from}
              x={x(from) + 0.5}
              y={y(n)}
              width={Math.max(1, x(to) - x(from) - 1)}
              height={Math.max(0, HEIGHT - BOTTOM - y(n))}
              fill={violates ? 'var(--c-worst)' : 'var(--c-nom)'}
              fillOpacity={violates ? 1 : 0.7}
            >
              <title>{`${short(from, decimals + 2)} to ${short(to, decimals + 2)} ${run.unit}: ${count(n)}`}</title>
            </rect>
          )
        })}
        <AxisBelow
          ticks={xs}
          at={x}
          foot={HEIGHT - BOTTOM}
          from={LEFT}
          to={width - RIGHT}
          title={<><SvgSign text={run.quantity || 'value'} />{ofUnit(run.unit)}</>}
        />
        {marks.map(({ value, ...mark }, row) => value !== null && <Marker key={row} {...mark} at={x(value)} row={row} width={width} />)}
      </svg>
      {off && threshold !== null && (
        <p className={figures.fig}>
          The criterion, {exact(threshold)} {run.unit}, is outside this axis.
        </p>
      )}
    </div>
  )
}

interface MarkerProps {
  at: number
  row: number
  text: string
  colour: string
  dashed?: boolean
  width: number
}

/** A labelled vertical line; labels are in rows, so that those of close lines do not overlap. */
function Marker({ at, row, text, colour, dashed, width }: MarkerProps) {
  const right = at > width * 0.6
  return (
    <>
      <path
        d={`M${at} ${row * 16 + 4}V${HEIGHT - BOTTOM}`}
        stroke={colour}
        strokeWidth={1.5}
        strokeDasharray={dashed ? '5 4' : undefined}
      />
      <text className={clsx(figures.lab, figures.halo)} x={at + (right ? -5 : 5)} y={row * 16 + 13} textAnchor={right ? 'end' : 'start'}>
        {text}
      </text>
    </>
  )
}
