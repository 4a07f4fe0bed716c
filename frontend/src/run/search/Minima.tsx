// The distinct minima of a method, merged as the findings are, and on request every descent: where it started and ended.
import { clsx } from 'clsx'
import { useState } from 'react'
import type { Minimum, SearchResult } from '../../client'
import { resultOf } from '../../api/stages'
import { count, decimalsApart, decimalsFor, fixed, NONE } from '../../format/numbers'
import { unitText } from '../../format/units'
import { Card, NumHead, Seg } from '../../ui/Card'
import { MethodName } from '../../ui/MethodMark'
import { Spans } from '../../ui/Spans'
import { Sign } from '../../ui/Sign'
import { type RunData, stageOf } from '../data/data'
import { basinsOf, distanceOf, type MergedMinimum, mergedMinima, rangesText } from './minima'
import buttons from '../../ui/buttons.module.css'
import layout from '../../ui/layout.module.css'
import tables from '../../ui/tables.module.css'

/** Initial and maximum number of rows. */
const SHOWN = 8
const MOST = 40

/** Number of rows initially shown, at most. */
export const rowsOf = (search: SearchResult): number => Math.min(search.minima.length, SHOWN)

interface MinimaProps {
  data: RunData
  search: SearchResult
  /** The position of its stage. */
  position: number
  className: string | undefined
  /** Starts above their ends instead of next to them, for many parameters. */
  tall?: boolean
}

export function Minima({ data, search, position, className, tall }: MinimaProps) {
  const { run, parameters, findings } = data
  const [every, setEvery] = useState(false)
  const [all, setAll] = useState(false)
  const validation = resultOf(stageOf(data, 'validate'), 'validate')
  const merged = mergedMinima(search.minima, basinsOf(validation, position), findings, parameters, distanceOf(validation?.findings))
  const total = every ? search.minima.length : merged.length
  const shown = Math.min(all ? MOST : SHOWN, total)
  const decimals = decimalsApart(search.minima.map(({ cost }) => cost), 5, 6)
  return (
    <Card
      title="Local minima"
      note={
        <>
          <MethodName method={search.method} title={search.title} />
          {every ? ' Every descent, in its order' : ` ${count(merged.length)} distinct of ${count(search.minima.length)} descents, the lowest first`}
        </>
      }
      className={className}
      flush
      right={
        <Seg
          label={`Minima of ${search.title}`}
          options={[{ value: 'distinct', label: 'Distinct' }, { value: 'every', label: 'Every descent' }]}
          value={every ? 'every' : 'distinct'}
          onChange={(value) => setEvery(value === 'every')}
        />
      }
      footer={
        total > SHOWN && (
          <span className={layout.row} style={{ justifyContent: 'space-between' }}>
            The {every ? 'first' : 'lowest'} {shown} of {count(total)}
            <button type="button" className={clsx(buttons.btn, buttons.s)} onClick={() => setAll(!all)}>
              {all ? 'Show fewer' : `Show ${Math.min(MOST, total)}`}
            </button>
          </span>
        )
      }
    >
      <table className={clsx(tables.table, tables.tight)}>
        <thead>
          <tr>
            <th className={every ? 'num' : undefined}>{every ? 'No.' : 'Finding'}</th>
            {parameters.map((p) => (
              <NumHead key={p.path} unit={unitText(p.unit)} title={p.path}>
                <Sign text={p.symbol} path={p.path} />
              </NumHead>
            ))}
            <NumHead unit={run.unit}><Sign text={run.quantity || 'value'} /></NumHead>
            {!every && <th className="num">Descents</th>}
            <th className="num">Evaluations</th>
            {every && <th>Ended</th>}
          </tr>
        </thead>
        <tbody>
          {every
            ? search.minima.slice(0, shown).map((minimum, i) => (
                <Descent key={i} data={data} minimum={minimum} number={i + 1} decimals={decimals} tall={tall} lowest={merged[0]?.lowest} />
              ))
            : merged.slice(0, shown).map((one, i) => <Distinct key={i} data={data} one={one} decimals={decimals} lowest={i === 0} />)}
        </tbody>
      </table>
    </Card>
  )
}

function Distinct({ data, one, decimals, lowest }: { data: RunData; one: MergedMinimum; decimals: number; lowest: boolean }) {
  return (
    <tr data-minimum={one.finding ?? ''}>
      <td className={one.finding ? 'b' : 'mut'}>{one.finding ?? 'in none'}</td>
      {data.parameters.map((p) => (
        <td key={p.path} className="num">
          {fixed(one.lowest.parameters[p.path], decimalsFor([p.low, p.high]))}
        </td>
      ))}
      <td className={lowest ? 'num b' : 'num'}>{fixed(one.lowest.cost, decimals)}</td>
      <td className="num sec" title={`No. ${rangesText(one.descents)}`}>
        {count(one.descents.length)}
      </td>
      <td className="num sec">{count(one.evaluations)}</td>
    </tr>
  )
}

interface DescentProps {
  data: RunData
  minimum: Minimum
  number: number
  decimals: number
  tall: boolean | undefined
  lowest: Minimum | undefined
}

/** A method that starts from its own sample reports no starts: then only the end is shown. */
function Descent({ data, minimum, number, decimals, tall, lowest }: DescentProps) {
  const { start } = minimum
  return (
    <tr>
      <td className="num sec">{number}</td>
      {data.parameters.map((p) => {
        const digits = decimalsFor([p.low, p.high])
        return (
          <td key={p.path} className="num">
            {start && (
              <span className="mut">
                {p.path in start ? fixed(start[p.path], digits) : NONE} {tall ? '' : '→ '}
              </span>
            )}
            {start && tall && <br />}
            {fixed(minimum.parameters[p.path], digits)}
          </td>
        )
      })}
      <td className={minimum === lowest ? 'num b' : 'num'}>{fixed(minimum.cost, decimals)}</td>
      <td className="num sec">{count(minimum.evaluations)}</td>
      <td className="sec"><Spans spans={minimum.statement} /></td>
    </tr>
  )
}
