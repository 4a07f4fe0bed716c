// Where the descents of a method ended, merged as the findings are, and on request every descent: its start, end and reason.
import { useState } from 'react'
import type { Minimum } from '../../client'
import { type MinimaResult, resultWith } from '../../api/stages'
import { count, decimalsApart, decimalsFor, fixed, NONE } from '../../format/numbers'
import { Button } from '../../ui/Button'
import { Card, Seg } from '../../ui/Card'
import { MethodName } from '../../ui/MethodMark'
import { Spans } from '../../ui/Spans'
import { Sign } from '../../ui/Sign'
import { Table } from '../../ui/Table'
import type { RunData, UncertainParameter } from '../data/data'
import { parameterColumns } from '../parameters/columns'
import { basinsOf, distanceOf, type MergedMinimum, mergedMinima, rangesText } from './minima'
import { layout } from '../../ui/styles'

/** Initial and maximum number of rows. */
const SHOWN = 8
const MOST = 40

/** Number of rows initially shown, at most. */
export const rowsOf = (search: MinimaResult): number => Math.min(search.minima.length, SHOWN)

interface MinimaProps {
  data: RunData
  search: MinimaResult
  /** The position of its stage. */
  position: number
  className?: string
  /** Starts above their ends instead of next to them, for many parameters. */
  tall?: boolean
}

export function Minima({ data, search, position, className, tall }: MinimaProps) {
  const { run, parameters, findings } = data
  const [every, setEvery] = useState(false)
  const [all, setAll] = useState(false)
  const validation = resultWith(data.stages, 'comparison')
  const merged = mergedMinima(search.minima, basinsOf(validation?.comparison, position), findings, parameters, distanceOf(validation?.findings))
  const total = every ? search.minima.length : merged.length
  const shown = Math.min(all ? MOST : SHOWN, total)
  const decimals = decimalsApart(search.minima.map(({ cost }) => cost), 5, 6)
  const value = { head: <Sign text={run.quantity || 'value'} />, unit: run.unit }
  const evaluations = { head: 'Evaluations', num: true, tone: 'sec' }
  return (
    <Card
      title="Ends of descents"
      note={
        <>
          <MethodName method={search.method} title={search.title} />
          {every ? ': every descent, in its order' : `: ${count(merged.length)} distinct of ${count(search.minima.length)} ${search.minima.length === 1 ? 'descent' : 'descents, the lowest first'}`}
        </>
      }
      className={className}
      flush
      right={
        <Seg
          label={`Ends of the descents of ${search.title}`}
          options={{ distinct: 'Distinct', every: 'Every descent' }}
          value={every ? 'every' : 'distinct'}
          onChange={(value) => setEvery(value === 'every')}
        />
      }
      footer={
        <>
          {total > SHOWN && (
            <span className={layout.row} style={{ justifyContent: 'space-between' }}>
              The {every ? 'first' : 'lowest'} {shown} of {count(total)}
              <Button small onClick={() => setAll(!all)}>{all ? 'Show fewer' : `Show ${Math.min(MOST, total)}`}</Button>
            </span>
          )}
          A descent that ended with its budget or at evaluations without a value need not have reached a minimum
          {every ? '.' : ': “Every descent” shows how each ended.'}
        </>
      }
    >
      {every ? (
        <Table
          tight
          rows={search.minima.slice(0, shown)}
          columns={[
            { head: 'No.', num: true, tone: 'sec', cell: (_, i) => i + 1 },
            ...parameterColumns<Minimum>(parameters, (minimum, p) => <Descent minimum={minimum} parameter={p} tall={tall} />, 'path'),
            { ...value, tone: (minimum) => minimum === merged[0]?.lowest && 'b', cell: ({ cost }) => fixed(cost, decimals) },
            { ...evaluations, cell: (minimum) => count(minimum.evaluations) },
            { head: 'Ended', tone: 'sec', cell: ({ statement }) => <Spans spans={statement} /> },
          ]}
        />
      ) : (
        <Table
          tight
          rows={merged.slice(0, shown)}
          row={({ finding }) => ({ 'data-minimum': finding ?? '' })}
          columns={[
            { head: 'In the basin of', tone: ({ finding }) => (finding ? 'b' : 'mut'), cell: ({ finding }) => finding ?? 'none' },
            ...parameterColumns<MergedMinimum>(parameters, ({ lowest }, p) => fixed(lowest.parameters[p.path], decimalsFor([p.low, p.high])), 'path'),
            { ...value, tone: (_, i) => i === 0 && 'b', cell: ({ lowest }) => fixed(lowest.cost, decimals) },
            { head: 'Descents', num: true, tone: 'sec', tip: ({ descents }) => `No. ${rangesText(descents)}`, cell: ({ descents }) => count(descents.length) },
            { ...evaluations, cell: (one) => count(one.evaluations) },
          ]}
        />
      )}
    </Card>
  )
}

interface DescentProps {
  minimum: Minimum
  parameter: UncertainParameter
  tall: boolean | undefined
}

/** A method that starts from its own sample reports no starts: then only the end is shown. */
function Descent({ minimum: { start, parameters }, parameter: { path, low, high }, tall }: DescentProps) {
  const digits = decimalsFor([low, high])
  return (
    <>
      {start && (
        <span className="mut">
          {path in start ? fixed(start[path], digits) : NONE} {tall ? '' : '→ '}
        </span>
      )}
      {start && tall && <br />}
      {fixed(parameters[path], digits)}
    </>
  )
}
