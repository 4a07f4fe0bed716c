// The worst cases of the runs, with their positions within the bounds.
import { clsx } from 'clsx'
import { plain } from '../format/numbers'
import { unitText } from '../format/units'
import { Card } from '../ui/Card'
import { Sign } from '../ui/Sign'
import type { Compared } from './data'
import { RunHeads } from './Picks'
import tables from '../ui/tables.module.css'

export function WorstParameters({ runs, className }: { runs: Compared[]; className: string | undefined }) {
  const paths = [...new Set(runs.flatMap(({ parameters }) => parameters.map((p) => p.path)))]
  return (
    <Card title="Worst case of each run" note="Grey tick: nominal of A" className={className} flush id="worst">
      <table className={clsx(tables.table, tables.tight)}>
        <thead>
          <tr>
            <th>Parameter</th>
            <RunHeads runs={runs} />
            <th>Within bounds</th>
          </tr>
        </thead>
        <tbody>
          {paths.map((path) => {
            const about = runs.flatMap(({ parameters }) => parameters.find((p) => p.path === path) ?? [])[0]
            const values = runs.map(({ findings }) => findings[0]?.parameters[path] ?? null)
            return (
              <tr key={path}>
                <td>
                  {about && <Sign text={about.symbol} />}{' '}
                  <span className="mut small">{about ? unitText(about.unit) : path}</span>
                </td>
                {values.map((value, i) => (
                  <td key={i} className="num">
                    {plain(value, 5)}
                  </td>
                ))}
                <td>
                  <Places runs={runs} path={path} values={values} />
                </td>
              </tr>
            )
          })}
        </tbody>
      </table>
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
