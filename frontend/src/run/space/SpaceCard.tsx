// The parameter space: every stage's evaluations with their value as colour, in parallel coordinates and over pairs of
// parameters. A range on an axis filters all views.
import { IconX } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { useEffect, useMemo, useState } from 'react'
import type { Evaluations, EvaluationSeries } from '../../client'
import { ChartCard } from '../../charts/ChartCard'
import { hasScenario } from '../../api/campaign'
import { useBarred } from '../../api/may'
import { useHidden } from '../../charts/Legend'
import { count, decimalsFor, fixed, plain } from '../../format/numbers'
import { unitText } from '../../format/units'
import type { RunData } from '../data/data'
import { useTheme } from '../../theme/useTheme'
import { Button } from '../../ui/Button'
import { Seg } from '../../ui/Card'
import { NOMINAL } from '../data/chosen'
import { useAddress } from '../data/useAddress'
import { Sign, symbolText } from '../../ui/Sign'
import { ColourBar } from './ColourBar'
import type { WhatIfState } from '../flight/useWhatIf'
import { valuesOf, type WhatIf } from '../flight/whatif'
import type { Ink } from './paint'
import { Parallel, type ViewProps } from './Parallel'
import { Reading } from './Reading'
import { Scatter } from './Scatter'
import { type Axis, type Brush, brushed, brushOf, brushTexts, criterionAxis, evaluationOf, FATES, keptOf, parametersAt, parametersOf, rankedFrom, type Space, spaceOf, VALUE, valueAxis, worstOf } from './space'
import { Toggles } from './Toggles'
import { Select } from '../../ui/Select'
import { buttons, layout } from '../../ui/styles'
import styles from './space.module.css'

/** Maximum number of drawn evaluations: more lines would only cover each other. */
const MOST = 4000
/** Maximum number of parameters for the cells of all pairs. */
const FEW = 4

interface Props {
  data: RunData
  /** With a selection of all evaluations; those of `data` have the improvements only. */
  evaluations: Evaluations
  /** The what-if whose result is shown here; null where the page has none. */
  whatIf: WhatIfState | null
  /** Simulates the parameters of an evaluation; null where nothing can be simulated. */
  onPick: ((next: WhatIf) => void) | null
}

export function SpaceCard({ data, evaluations, whatIf, onPick: pick }: Props) {
  const onPick = useBarred('engineer') === undefined ? pick : null
  const { run, catalogue, parameters } = data
  const theme = useTheme()
  const [address, change] = useAddress(run.id)
  const further = useMemo(() => run.criteria.slice(1), [run.criteria])
  const space = useMemo(() => {
    const value = valueAxis(evaluations, run.quantity || 'value', run.unit, run.threshold)
    const titleOf = ({ method, kind }: EvaluationSeries) =>
      catalogue?.methods.find((m) => m.name === method)?.title ?? method ?? kind.charAt(0).toUpperCase() + kind.slice(1)
    // Stages stored by an older version have only the deciding criterion.
    const criteria = evaluations.stages.every((series) => further.every(({ name }) => series.further[name])) ? further : []
    const axes = [value, ...criteria.map((c) => criterionAxis(evaluations, c)), ...parameters.map((p) => ({ ...p, key: p.path }))]
    return spaceOf({ evaluations, axes, titleOf, most: MOST })
  }, [evaluations, parameters, catalogue, further, run.quantity, run.unit, run.threshold])
  const [brush, setBrush] = useAddressedBrush(run.id, space.axes)
  const [hidden, toggle] = useHidden()
  const [over, setOver] = useState<number | null>(null)
  const [first = 1, second = 2] = parametersOf(space.axes)
  const [chosenPair, setPair] = useState<readonly [number, number] | null>(null)
  const pair = chosenPair ?? ([first, second] as const)
  const by = Math.max(0, space.axes.findIndex(({ key }) => key === address.by))
  const kept = useMemo(() => keptOf(space, brush, hidden), [space, brush, hidden])
  const worst = useMemo(() => worstOf(space, kept), [space, kept])
  const ink = useMemo((): Ink => {
    const values = (space.columns[by] ?? new Float64Array()).filter((value) => !Number.isNaN(value))
    const [low, high] = [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)]
    return { theme, low, high, axis: by, turned: space.axes[by]?.worse === 'high' }
  }, [space, theme, by])
  const picked = whatIf?.whatIf ?? null
  const simulated = useMemo(() => picked && evaluationOf(space, kept, valuesOf(picked, data), picked.seed), [space, kept, picked, data])
  if (space.count === 0 || parameters.length === 0) return null
  const view: ViewProps = {
    space,
    kept,
    brush,
    onBrush: (axis, range) => setBrush((before) => brushed(before, axis, range)),
    ink,
    worst,
    // A filtered evaluation under the pointer is no longer highlighted.
    over: over !== null && kept.includes(over) ? over : null,
    onOver: setOver,
    simulated,
    onPick: onPick && ((at) => onPick({ like: NOMINAL, set: parametersAt(space, at), seed: space.seeds[at] ?? null })),
    threshold: run.threshold,
  }
  const at = view.over ?? simulated ?? worst
  const flies = hasScenario(data.campaign)
  const some = space.fates.some((fate) => fate > 0)
  const many = parameters.length > FEW
  const height = many ? 340 : [0, 300, 320, 400, 480][parameters.length]
  return (
    <ChartCard
      title="Parameter space"
      note={
        space.count < space.total
          ? `${count(space.count)} of ${count(space.total)} evaluations shown: the lowest of each stage and an even selection${space.stored < space.total ? ` of the ${count(space.stored)} that are stored` : ''}`
          : `All ${count(space.total)} evaluations of all stages`
      }
      run={run.id}
      data={() => tableOf(space, kept)}
      footer={`${onPick ? `Click an evaluation to ${flies ? 'simulate it' : 'use its values in the what-if'}. ` : ''}Drag along an axis or in a cell to select a range; drag its ends to change it, click next to the evaluations to clear it. The data and the CSV file contain the selection.`}
    >
      <div className={styles.space} onKeyDown={(event) => event.key === 'Escape' && setBrush({})}>
        <div className={styles.head}>
          <div>
            <Toggles space={space} hidden={hidden} onToggle={toggle} />
            <Ranges {...view} onClear={() => setBrush({})} />
          </div>
          <div className={clsx(layout.row, layout.atend, styles.by)}>
            {further.length > 0 && (
              <Seg
                label="Colours by"
                options={Object.fromEntries(run.criteria
                  .filter((_, k) => k === 0 || space.axes[k]?.worse)
                  .map((c, k) => [k === 0 ? VALUE : c.name, c.title]))}
                value={space.axes[by]?.key ?? VALUE}
                onChange={(name) => change({ by: name === VALUE ? undefined : name })}
              />
            )}
            {ink.low <= ink.high && (
              <ColourBar
                ink={ink}
                symbol={space.axes[by]?.symbol ?? 'value'}
                unit={space.axes[by]?.unit ?? ''}
                threshold={by === 0 ? run.threshold : null}
              />
            )}
          </div>
        </div>
        <div className={styles.views}>
          <Parallel {...view} height={height ?? 340} none={some} />
          <div>
            {many && <Pair axes={space.axes} pair={pair} onPair={setPair} />}
            <Scatter {...view} height={(height ?? 340) - (many ? 34 : 0)} pair={many ? pair : null} />
          </div>
        </div>
        <Reading
          space={space}
          at={at}
          lowest={at === worst}
          simulated={at !== null && at === simulated}
          failures={evaluations.failures}
          whatIf={whatIf}
          onStep={(step) => at !== null && setOver(rankedFrom(space, kept, at, step))}
          onPick={view.onPick}
          flies={flies}
        />
      </div>
    </ChartCard>
  )
}

/** The ranges, also in the address, so that a copied link shows the same. */
function useAddressedBrush(id: string, axes: readonly Axis[]) {
  const [{ brush: stored }, change] = useAddress(id)
  const [brush, setBrush] = useState<Brush>(() => brushOf(stored ?? [], axes))
  const texts = brushTexts(brush).join(' ')
  const there = stored?.join(' ') ?? ''
  useEffect(() => {
    if (texts === there) return
    // The address is updated after the range stops changing.
    const timer = setTimeout(() => change({ brush: texts ? texts.split(' ') : undefined }), 300)
    return () => clearTimeout(timer)
  }, [texts, there, change])
  return [brush, setBrush] as const
}

interface RangesProps extends ViewProps {
  onClear: () => void
}

/** The number of selected evaluations, their lowest value, and each range with a button to remove it. */
function Ranges({ space, kept, worst, brush, onBrush, onClear }: RangesProps) {
  const value = space.axes[0] as Axis
  const lowest = worst === null ? null : space.columns[0]?.[worst]
  const ranged = space.axes.filter((axis) => brush[axis.key])
  return (
    <div className={clsx(layout.row, styles.ranges)}>
      <span className="small" aria-live="polite" data-testid="kept">
        <b>{count(kept.length)}</b> of {count(space.count)} {space.count < space.total ? 'drawn evaluations' : 'evaluations'} selected
        {lowest === null ? (
          ', none with a value'
        ) : (
          <>
            , lowest <Sign text={value.symbol} />{' '}
            <b>
              {plain(lowest, 5)} {unitText(value.unit)}
            </b>
          </>
        )}
      </span>
      {ranged.map((axis) => {
        const [from, to] = brush[axis.key] as readonly [number, number]
        const decimals = decimalsFor([axis.low, axis.high], 4)
        return (
          <button
            key={axis.key}
            type="button"
            className={clsx('m nw', buttons.chip, buttons.on)}
            onClick={() => onBrush(axis, null)}
          >
            <span>
              <span className="sr">Clear range of </span>
              <Sign text={axis.symbol} path={axis.key} /> {fixed(from, decimals)} to {fixed(to, decimals)} {unitText(axis.unit)}
            </span>
            <IconX className="i" aria-hidden />
          </button>
        )
      })}
      {ranged.length > 0 && (
        <Button small onClick={onClear}>Clear brush</Button>
      )}
    </div>
  )
}

function Pair({ axes, pair, onPair }: { axes: Axis[]; pair: readonly [number, number]; onPair: (pair: readonly [number, number]) => void }) {
  const choice = (name: string, end: 0 | 1) => (
    <label className={clsx(layout.row, 'small mut')}>
      {name}
      <Select
        value={pair[end]}
        options={axes.map((axis, k) => ({
          value: k,
          label: `${symbolText(axis.symbol)}${axis.unit && `, ${unitText(axis.unit)}`}`,
          disabled: k === pair[end === 0 ? 1 : 0],
        }))}
        onChange={(axis) => onPair(end === 0 ? [axis, pair[1]] : [pair[0], axis])}
      />
    </label>
  )
  return (
    <div className={clsx(layout.row, styles.pair)}>
      {choice('Vertical', 1)}
      {choice('Horizontal', 0)}
    </div>
  )
}

function tableOf(space: Space, kept: Uint32Array) {
  const headed = (axis: Axis) => {
    const name = axis === space.axes[0] || axis.worse ? symbolText(axis.symbol) : axis.key
    return axis.unit ? `${name}, ${axis.unit}` : name
  }
  return {
    name: 'parameter-space',
    columns: ['stage', 'evaluation', 'status', ...space.axes.map(headed)],
    rows: [...kept].map((i) => [
      space.groups[space.of[i] as number]?.title ?? '',
      (space.index[i] as number) + 1,
      FATES[space.fates[i] as number] ?? '',
      ...space.columns.map((column) => (Number.isNaN(column[i]) ? null : (column[i] as number))),
    ]),
  }
}
