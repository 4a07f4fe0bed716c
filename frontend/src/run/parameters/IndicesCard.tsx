// Global sensitivity: Morris' elementary effects and Sobol indices, one row per parameter.
import { clsx } from 'clsx'
import type { SensitivityResult } from '../../client'
import { count, NONE, percent, plain } from '../../format/numbers'
import { words } from '../../format/spans'
import { Card } from '../../ui/Card'
import { Spans } from '../../ui/Spans'
import { Sign } from '../../ui/Sign'
import type { RunData } from '../data/data'
import tables from '../../ui/tables.module.css'

interface IndicesCardProps {
  data: RunData
  result: SensitivityResult
  className: string | undefined
}

interface Column {
  name: string
  values: Map<string, string>
}

export function IndicesCard({ data, result, className }: IndicesCardProps) {
  const { run, parameters } = data
  const { morris, sobol } = result
  const effects = (name: 'mu' | 'mu_star' | 'sigma') =>
    new Map((morris?.indices ?? []).map((row) => [row.path, plain(row[name], 3)]))
  const shares = (name: 'first' | 'total') =>
    new Map((sobol?.indices ?? []).map((row) => [row.path, spread(row[name], row[`${name}_confidence`])]))
  const columns: Column[] = [
    ...(morris?.indices
      ? [
          { name: 'μ', values: effects('mu') },
          { name: 'μ*', values: effects('mu_star') },
          { name: 'σ', values: effects('sigma') },
        ]
      : []),
    ...(sobol?.indices
      ? [
          { name: 'First order', values: shares('first') },
          { name: 'Total', values: shares('total') },
        ]
      : []),
  ]
  return (
    <Card
      title="Sensitivity indices"
      note={[
        morris && `Morris, ${count(morris.evaluations)} evaluations`,
        sobol && `Sobol, ${count(sobol.evaluations)} evaluations`,
      ]
        .filter(Boolean)
        .join('; ')}
      className={className}
      flush={columns.length > 0}
      footer={
        <>
          {morris?.indices && `μ, μ* and σ are per whole range, in ${run.unit}. `}
          {morris && !morris.indices && <Spans spans={[words('Morris: '), ...morris.statement, words('. ')]} />}
          {sobol?.indices &&
            `Indices are fractions of the variance, ± half the width of their ${percent(sobol.confidence)} interval.`}
          {sobol && !sobol.indices && <Spans spans={[words('Sobol: '), ...sobol.statement, words('.')]} />}
        </>
      }
    >
      {columns.length > 0 ? (
        <table className={clsx(tables.table, tables.tight)}>
          <thead>
            <tr>
              <th>Parameter</th>
              {columns.map((column) => (
                <th key={column.name} className="num">
                  {column.name}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {parameters.map((parameter) => (
              <tr key={parameter.path} title={parameter.text}>
                <td>
                  <Sign text={parameter.symbol} path={parameter.path} />
                </td>
                {columns.map((column) => (
                  <td key={column.name} className="num">
                    {column.values.get(parameter.path) ?? NONE}
                  </td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      ) : (
        <p className="sec">No index was computed.</p>
      )}
    </Card>
  )
}

const spread = (value: number | null, half: number | null): string =>
  value === null ? NONE : `${plain(value, 3)} ± ${half === null ? NONE : plain(half, 2)}`
