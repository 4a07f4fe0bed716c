// Global sensitivity: Morris' elementary effects and Sobol indices, one row per parameter.
import type { SlicesResult } from '../../api/stages'
import { confidenceText, count, NONE, plain, spread } from '../../format/numbers'
import { words } from '../../format/spans'
import { Card } from '../../ui/Card'
import { Spans } from '../../ui/Spans'
import { Sign } from '../../ui/Sign'
import { layout } from '../../ui/styles'
import { type Column, Table } from '../../ui/Table'
import type { RunData, UncertainParameter } from '../data/data'

interface IndicesCardProps {
  data: RunData
  result: SlicesResult
}

export function IndicesCard({ data, result }: IndicesCardProps) {
  const { run, parameters } = data
  const { morris, sobol } = result
  const effects = (head: string, name: 'mu' | 'mu_star' | 'sigma'): Column<UncertainParameter> => {
    const values = new Map((morris?.indices ?? []).map((row) => [row.path, plain(row[name], 3)]))
    return { head, num: true, cell: ({ path }) => values.get(path) ?? NONE }
  }
  const fractions = (head: string, name: 'first' | 'total'): Column<UncertainParameter> => {
    const values = new Map((sobol?.indices ?? []).map((row) => [row.path, spread(row[name], row[`${name}_confidence`])]))
    return { head, num: true, cell: ({ path }) => values.get(path) ?? NONE }
  }
  const columns = [
    ...(morris?.indices ? [effects('μ', 'mu'), effects('μ*', 'mu_star'), effects('σ', 'sigma')] : []),
    ...(sobol?.indices ? [fractions('First order', 'first'), fractions('Total', 'total')] : []),
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
      className={layout.c12}
      flush={columns.length > 0}
      footer={
        <>
          {morris?.indices && `μ, μ* and σ are per whole range, in ${run.unit}. `}
          {morris && !morris.indices && <Spans spans={[words('Morris: '), ...morris.statement, words('. ')]} />}
          {sobol?.indices &&
            `Indices are fractions of the variance, ± half the width of their ${confidenceText(sobol.confidence)} interval by bootstrap, where at least ten evaluations decide them.`}
          {sobol && !sobol.indices && <Spans spans={[words('Sobol: '), ...sobol.statement, words('.')]} />}
        </>
      }
    >
      {columns.length > 0 ? (
        <Table
          tight
          rows={parameters}
          row={({ text }) => ({ title: text })}
          columns={[{ head: 'Parameter', cell: ({ symbol, path }) => <Sign text={symbol} path={path} /> }, ...columns]}
        />
      ) : (
        <p className="sec">No index was computed.</p>
      )}
    </Card>
  )
}
