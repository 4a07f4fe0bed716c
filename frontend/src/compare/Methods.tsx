// The best value of each method in each run, on one axis with the criterion.
import { decimalsApart, exact, fixed, NONE, signed } from '../format/numbers'
import { Card } from '../ui/Card'
import { MethodName } from '../ui/MethodMark'
import { useMethodLook } from '../ui/methods'
import { Sign } from '../ui/Sign'
import { Table } from '../ui/Table'
import { type Compared, haveDifferences, unitOf } from './data'
import { AxisHead, axisOf, Mark, MarkKeys } from './marks'
import { apartColumn, foundColumns } from './Picks'
import { figures } from '../ui/styles'

const [WIDTH, EDGE] = [280, 10]

interface Row {
  method: string
  /** The best value in each run. */
  values: (number | null)[]
}

export function Methods({ runs, className }: { runs: Compared[]; className: string | undefined }) {
  const methodLook = useMethodLook()
  const unit = unitOf(runs)
  const two = haveDifferences(runs)
  const bests = runs.map(bestsOf)
  const methods = [...new Set(bests.flatMap((found) => [...found.keys()]))]
  const values = bests.flatMap((found) => [...found.values()])
  const limits = [...new Set(runs.flatMap(({ run }) => run.threshold ?? []))]
  const axis = axisOf(values, limits, WIDTH, EDGE)
  const { x, shown } = axis
  const decimals = decimalsApart(values, 4, 6)
  return (
    <Card
      title={
        <>
          Best <Sign text={runs[0]?.run.quantity || 'value'} /> by method
        </>
      }
      note={`${unit}${shown.length === 0 && limits.length > 0 ? '; the criterion is off this axis' : ''}`}
      className={className}
      flush
      id="methods"
      right={<MarkKeys letters={runs.map(({ letter }) => letter)} />}
    >
      <Table
        rows={methods.map((method) => ({ method, values: bests.map((found) => found.get(method) ?? null) }))}
        row={({ method }) => ({ 'data-method': method })}
        columns={[
          { head: 'Method', cell: ({ method }) => <MethodName method={method} /> },
          ...foundColumns<Row>(
            runs,
            ({ method, values }, k) => (values[k] == null ? <span className="mut">{absent(runs[k], method)}</span> : fixed(values[k], decimals)),
            ({ values }, k) => isBad(values[k], runs[k]) && 'bad-t',
          ),
          two && apartColumn<Row>(({ values: [a, b] }) => (typeof a === 'number' && typeof b === 'number' ? signed(b - a, decimals) : NONE)),
          {
            head: <AxisHead axis={axis} />,
            width: WIDTH,
            cell: ({ method, values }) => (
              <svg className={figures.ch} width={WIDTH} height={18} style={{ width: WIDTH }} aria-hidden="true">
                <path d={`M${EDGE} 9H${WIDTH - EDGE}`} stroke="var(--line)" />
                {shown.map((limit) => (
                  <path key={limit} className={figures.cr} d={`M${x(limit)} 0V18`} />
                ))}
                <Dumbbell values={values} x={x} colour={`var(${methodLook(method).colour})`} />
              </svg>
            ),
          },
        ]}
      />
      {shown.length > 0 && <p className="sr">Criterion: {shown.map((limit) => exact(limit)).join(', ')}</p>}
    </Card>
  )
}

/** The best value of each method of a run. */
function bestsOf({ run }: Compared): Map<string, number> {
  const found = new Map<string, number>()
  for (const { method, best } of run.stages)
    if (method && best !== null) found.set(method, Math.min(best, found.get(method) ?? Infinity))
  return found
}

/** Why a method has no best value in a run. */
function absent(of: Compared | undefined, method: string): string {
  const stages = of?.run.stages.filter((stage) => stage.method === method) ?? []
  if (stages.length === 0) return 'not run'
  return stages.some(({ evaluations }) => evaluations > 0) ? 'no value' : 'waiting'
}

/** How many methods of all runs have a best value. */
export const bestsIn = (runs: Compared[]): number => runs.reduce((sum, of) => sum + bestsOf(of).size, 0)

const isBad = (value: number | null | undefined, of: Compared | undefined): boolean =>
  value != null && of?.run.threshold !== null && of !== undefined && value <= of.run.threshold

function Dumbbell({ values, x, colour }: { values: (number | null)[]; x: (value: number) => number; colour: string }) {
  const known = values.flatMap((value) => (value === null ? [] : x(value)))
  if (known.length === 0) return null
  return (
    <>
      <path d={`M${Math.min(...known)} 9H${Math.max(...known)}`} stroke={colour} strokeWidth={1.6} />
      {values.map((value, i) => value !== null && <Mark key={i} x={x(value)} y={9} index={i} colour={colour} />)}
    </>
  )
}
