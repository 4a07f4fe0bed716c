// The random samples of the runs on one axis, each as a density, so that samples of different size can be compared.
import { clsx } from 'clsx'
import { independentSample, sampleTitle } from '../api/stages'
import type { Sample } from '../client'
import { AxisBelow } from '../charts/axes'
import { ChartCard } from '../charts/ChartCard'
import { linearTicks, padded } from '../charts/ticks'
import { violatedOf } from '../format/counts'
import { exact } from '../format/numbers'
import { SvgSign } from '../ui/Sign'
import { useWidth } from '../ui/useWidth'
import { type Compared, unitOf } from './data'
import { RunKeys } from './Overlays'
import { figures } from '../ui/styles'

interface Drawn {
  of: Compared
  edges: number[]
  /** Fraction of the sample per unit of the value. */
  density: number[]
  sample: Sample
  /** What it is called: independent only if its seed was drawn at the launch. */
  title: string
}

/** The samples of all runs that bound P(violation); none where the runs have different units. */
export const samplesIn = (runs: Compared[]): Drawn[] =>
  (unitOf(runs) === null ? [] : runs).flatMap((of): Drawn[] => {
    const sample = independentSample(of.stages)
    const { edges = [], counts = [] } = sample?.histogram ?? {}
    const total = counts.reduce((sum, n) => sum + n, 0)
    if (!sample || total === 0) return []
    const density = counts.map((n, i) => n / total / ((edges[i + 1] ?? 0) - (edges[i] ?? 0) || 1))
    return [{ of, edges, density, sample, title: sampleTitle(of.stages, sample) }]
  })

export function Samples({ runs, className }: { runs: Compared[]; className: string | undefined }) {
  const drawn = samplesIn(runs)
  const titles = [...new Set(drawn.map(({ title }) => title))]
  const table = () => ({
    name: 'samples',
    columns: ['run', 'from', 'to', 'density'],
    rows: drawn.flatMap(({ of, edges, density }) => density.map((d, i) => [of.id, edges[i] ?? null, edges[i + 1] ?? null, d])),
  })
  return (
    <ChartCard
      title={titles.length === 1 ? `${titles[0]}s` : 'Random samples'}
      className={className}
      id="samples"
      run={runs.map(({ id }) => id).join('-')}
      data={table}
      right={<RunKeys runs={drawn.map(({ of }) => of)} />}
      footer={drawn
        .map(({ of, sample, title }) => `${of.letter}: ${titles.length === 1 ? '' : `${title.toLowerCase()}, `}${violatedOf(sample)}`)
        .join('. ')}
    >
      <Densities drawn={drawn} />
    </ChartCard>
  )
}

const [HEIGHT, LEFT, BOTTOM, RIGHT, TOP] = [280, 16, 38, 12, 22]

function Densities({ drawn }: { drawn: Drawn[] }) {
  const [holder, width] = useWidth(420)
  const [first] = drawn
  const values = drawn.flatMap(({ edges }) => edges)
  const [least, most] = [Math.min(...values), Math.max(...values)]
  const limits = [...new Set(drawn.flatMap(({ of }) => of.run.threshold ?? []))]
  const shown = limits.filter((limit) => limit > least - 2 * (most - least) && limit < most + 2 * (most - least))
  const [low, high] = padded([...values, ...shown], 0.04)
  const peak = Math.max(...drawn.flatMap(({ density }) => density))
  const x = (value: number) => LEFT + ((width - LEFT - RIGHT) * (value - low)) / (high - low)
  const y = (density: number) => HEIGHT - BOTTOM - ((HEIGHT - BOTTOM - TOP) * density) / peak
  const ticks = linearTicks(low, high, Math.max(3, width / 100))
  return (
    <div ref={holder}>
      <div className="sec micro">Density of the sampled evaluations</div>
      <svg className={figures.ch} height={HEIGHT} role="img" aria-label="Samples of the runs as densities">
        <AxisBelow
          ticks={ticks}
          at={x}
          foot={HEIGHT - BOTTOM}
          top={TOP}
          from={LEFT}
          to={width - RIGHT}
          title={<><SvgSign text={first?.of.run.quantity || 'value'} />, {first?.of.run.unit}</>}
        />
        {drawn.map(({ of, edges, density }, i) => (
          <path
            key={of.letter}
            d={outline(edges, density, x, y)}
            fill={i === 0 ? 'var(--c-nom)' : 'none'}
            fillOpacity={0.45}
            stroke="var(--ink-2)"
            strokeWidth={i === 0 ? 1 : 1.7}
            strokeDasharray={of.dash.join(' ') || undefined}
          />
        ))}
        {shown.map((limit, i) => (
          <g key={limit}>
            <path className={figures.cr} d={`M${x(limit)} ${TOP - 8}V${HEIGHT - BOTTOM}`} />
            <text className={clsx(figures.lab, figures.halo)} x={x(limit)} y={TOP - 11 + 13 * i} textAnchor={x(limit) > width / 2 ? 'end' : 'start'}>
              Criterion {exact(limit)}
            </text>
          </g>
        ))}
      </svg>
      {shown.length === 0 && limits.length > 0 && <p className={figures.fig}>The criterion is off this axis.</p>}
    </div>
  )
}

function outline(edges: number[], density: number[], x: (v: number) => number, y: (d: number) => number): string {
  const steps = density.map((d, i) => `L${x(edges[i] ?? 0)} ${y(d)}H${x(edges[i + 1] ?? 0)}`)
  return `M${x(edges[0] ?? 0)} ${y(0)}${steps.join('')}L${x(edges[edges.length - 1] ?? 0)} ${y(0)}`
}
