// One-at-a-time ranges: the values over the bounds of each parameter, with the others nominal.
import { resultWith } from '../api/stages'
import { plain } from '../format/numbers'
import { Card } from '../ui/Card'
import { Sign } from '../ui/Sign'
import { Table } from '../ui/Table'
import { type Compared, parameterOf, unitOf } from './data'
import { AxisHead, axisOf, MarkKeys, Span } from './marks'
import { figures } from '../ui/styles'

const [WIDTH, EDGE, STEP] = [300, 12, 13]

export function Ranges({ runs, className }: { runs: Compared[]; className: string | undefined }) {
  const unit = unitOf(runs)
  const spans = runs.map(spansOf)
  const paths = [...new Set(spans.flatMap((found) => [...found.keys()]))]
  const values = spans.flatMap((found) => [...found.values()].flat())
  if (unit === null) return null
  const limits = [...new Set(runs.flatMap(({ run }) => run.threshold ?? []))]
  const axis = axisOf(values, limits, WIDTH, EDGE)
  const { x, shown } = axis
  const height = 6 + STEP * runs.length
  return (
    <Card
      title="One-at-a-time ranges"
      note={`${unit}; one parameter over its bounds, the others nominal`}
      className={className}
      flush
      id="ranges"
      right={<MarkKeys letters={runs.map(({ letter }) => letter)} />}
    >
      <Table
        tight
        rows={paths}
        row={(path) => ({ 'data-path': path })}
        columns={[
          {
            head: 'Parameter',
            tip: (path) => parameterOf(runs, path)?.text,
            cell: (path) => {
              const symbol = parameterOf(runs, path)?.symbol
              return symbol === undefined ? <span className="mono">{path}</span> : <Sign text={symbol} />
            },
          },
          {
            head: <AxisHead axis={axis} />,
            width: WIDTH,
            cell: (path) => (
              <>
                <svg className={figures.ch} width={WIDTH} height={height} style={{ width: WIDTH }} aria-hidden="true">
                  {shown.map((limit) => (
                    <path key={limit} className={figures.cr} d={`M${x(limit)} 0V${height}`} />
                  ))}
                  {spans.map((found, i) => {
                    const span = found.get(path)
                    return span && <Span key={i} from={x(span[0])} to={x(span[1])} y={9 + STEP * i} index={i} />
                  })}
                </svg>
                <span className="sr">{runs.map(({ letter }, i) => `${letter}: ${textOf(spans[i]?.get(path), unit)}`).join('; ')}</span>
              </>
            ),
          },
        ]}
      />
      {shown.length === 0 && limits.length > 0 && <p className={figures.fig}>The criterion is off this axis.</p>}
    </Card>
  )
}

/** The lowest and highest value of each curve, without failed evaluations. */
function spansOf({ stages }: Compared): Map<string, [number, number]> {
  const found = new Map<string, [number, number]>()
  for (const { path, costs } of resultWith(stages, 'curves')?.curves ?? []) {
    const known = costs.filter((cost): cost is number => cost !== null)
    if (known.length > 0) found.set(path, [Math.min(...known), Math.max(...known)])
  }
  return found
}

/** How many ranges all runs have. */
export const rangesIn = (runs: Compared[]): number => runs.reduce((sum, of) => sum + spansOf(of).size, 0)

const textOf = (span: [number, number] | undefined, unit: string): string =>
  span ? `${plain(span[0], 5)} to ${plain(span[1], 5)} ${unit}` : 'not varied'
