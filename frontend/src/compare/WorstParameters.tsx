// The worst cases of the runs, with their positions within the bounds.
import { plain } from '../format/numbers'
import { unitText } from '../format/units'
import { worstOf } from '../run/data/chosen'
import { Card } from '../ui/Card'
import { Sign } from '../ui/Sign'
import { Table } from '../ui/Table'
import { type Compared, parameterOf } from './data'
import { foundColumns } from './Picks'

export function WorstParameters({ runs }: { runs: Compared[] }) {
  const paths = [...new Set(runs.flatMap(({ parameters }) => parameters.map((p) => p.path)))]
  const rows = paths.map((path) => ({ path, parameter: parameterOf(runs, path), values: runs.map(({ run, findings }) => findings.find(({ label }) => label === worstOf(run))?.parameters[path] ?? null) }))
  return (
    <Card title="Worst case of each run" note="Grey tick: nominal of A" flush id="worst">
      <Table
        tight
        rows={rows}
        columns={[
          {
            head: 'Parameter',
            cell: ({ path, parameter }) => (
              <>
                {parameter && <Sign text={parameter.symbol} />} <span className="mut small">{parameter ? unitText(parameter.unit) : path}</span>
              </>
            ),
          },
          ...foundColumns<(typeof rows)[number]>(runs, ({ values }, k) => plain(values[k], 5)),
          { head: 'Within bounds', cell: ({ path, values }) => <Places runs={runs} path={path} values={values} /> },
        ]}
      />
    </Card>
  )
}

const [WIDTH, EDGE] = [160, 9]

/** All worst cases on one axis over all bounds: the first filled, the others as rings around it. */
function Places({ runs, path, values }: { runs: Compared[]; path: string; values: (number | null)[] }) {
  const bounds = runs.flatMap(({ parameters }) => parameters.find((p) => p.path === path) ?? [])
  const low = Math.min(...bounds.map((p) => p.low))
  const high = Math.max(...bounds.map((p) => p.high))
  const x = (value: number) => EDGE + ((WIDTH - 2 * EDGE) * (value - low)) / (high - low || 1)
  const nominal = bounds[0]?.nominal
  return (
    <svg width={WIDTH} height={18} viewBox={`0 0 ${WIDTH} 18`} style={{ display: 'block' }} aria-hidden="true">
      <path d={`M${EDGE} 9H${WIDTH - EDGE}`} stroke="var(--line-2)" strokeWidth={1.5} />
      {nominal !== undefined && <path d={`M${x(nominal)} 4v10`} stroke="var(--c-nom)" strokeWidth={2} />}
      {values.map(
        (value, i) =>
          value !== null && (
            <circle
              key={i}
              cx={x(value)}
              cy={9}
              r={2.8 + 2.2 * i}
              fill={i === 0 ? 'var(--c-worst)' : 'none'}
              stroke="var(--c-worst)"
              strokeWidth={1.6}
              strokeDasharray={i > 1 ? '2 2' : undefined}
            />
          ),
      )}
    </svg>
  )
}
