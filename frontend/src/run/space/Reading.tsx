// One evaluation of the parameter space as text, with its simulation. Its buttons do by keyboard what a click in the
// drawings does.
import { clsx } from 'clsx'
import { Fragment } from 'react'
import type { EvaluationFailure } from '../../client'
import { count, decimalsBeside, margin as marginText, plain } from '../../format/numbers'
import { unitText } from '../../format/units'
import { Button } from '../../ui/Button'
import { Sign } from '../../ui/Sign'
import type { WhatIfState } from '../flight/useWhatIf'
import { againOf } from './again'
import { FATES, type Space } from './space'
import { layout } from '../../ui/styles'
import styles from './space.module.css'

interface Props {
  space: Space
  /** The evaluation pointed at, else the simulated one, else the lowest selected. */
  at: number | null
  lowest: boolean
  simulated: boolean
  failures: readonly EvaluationFailure[]
  /** The what-if of the page; null where nothing can be simulated. */
  whatIf: WhatIfState | null
  /** Points at the evaluation with the next value. */
  onStep: (step: 1 | -1) => void
  onPick: ((evaluation: number) => void) | null
  /** Whether a scenario is simulated; a simulator is evaluated on request. */
  flies: boolean
}

export function Reading({ space, at, lowest, simulated, failures, whatIf, onStep, onPick, flies }: Props) {
  if (at === null) return <p className={clsx('small mut tn', styles.read)}>No selected evaluation has a value.</p>
  const group = space.groups[space.of[at] as number]
  const fate = FATES[space.fates[at] as number]
  const values = space.axes.map((axis, k) => ({ axis, value: space.columns[k]?.[at] as number })).filter(({ value }) => !Number.isNaN(value))
  const reason = failures.find((one) => String(one.position) === group?.key && one.index === space.index[at])?.reason
  return (
    <div className={clsx('small sec tn', styles.read)}>
      <p>
        <b className={lowest ? 'bad-t' : undefined}>{simulated ? 'Simulated' : lowest ? 'Lowest selected' : 'Pointed at'}</b>: {group?.title}, evaluation{' '}
        {count((space.index[at] as number) + 1)}
        {fate !== 'ok' && `, ${fate}${reason ? ` (${reason})` : ''}`}:{' '}
        {values.map(({ axis, value }, k) => (
          <Fragment key={axis.key}>
            {k > 0 && '; '}
            <span className="nw">
              <Sign text={axis.symbol} path={axis.key} /> = {plain(value, 5)}
              {axis.unit && ` ${unitText(axis.unit)}`}
            </span>
          </Fragment>
        ))}
      </p>
      <div className={clsx(layout.row, styles.ranges)}>
        <Button small onClick={() => onStep(-1)}>Lower value</Button>
        <Button small onClick={() => onStep(1)}>Higher value</Button>
        {onPick && (
          <Button small onClick={() => onPick(at)}>{flies ? 'Simulate' : 'Use its values'}</Button>
        )}
        {whatIf && (
          <span role="status" aria-label={flies ? 'Simulated again' : 'Evaluated again'}>
            {simulated && <Again space={space} at={at} whatIf={whatIf} flies={flies} />}
          </span>
        )}
      </div>
    </div>
  )
}

/** The result of the simulation next to the stored one, and the way to its flight. */
function Again({ space, at, whatIf, flies }: { space: Space; at: number; whatIf: WhatIfState; flies: boolean }) {
  const { answer, refused, busy, stale, follows } = whatIf
  const value = space.axes[0]
  if (busy || (stale && follows)) return flies ? 'Simulating …' : 'Evaluating …'
  if (stale) return <Shown>Its values are in the what-if, which evaluates them on request</Shown>
  if (!answer) return refused
  const { cost, margin } = answer
  const decimals = decimalsBeside([cost], answer.threshold)
  return (
    <Shown>
      {flies ? 'Simulated' : 'Evaluated'} again:{' '}
      {cost !== null && (
        <>
          <Sign text={value?.symbol ?? 'value'} /> = {plain(cost, 5)} {unitText(answer.unit)}, margin {marginText(margin, decimals)} {unitText(answer.unit)};{' '}
        </>
      )}
      {againOf(answer, { cost: space.columns[0]?.[at] ?? Number.NaN, fate: FATES[space.fates[at] as number] ?? 'ok' })}
    </Shown>
  )
}

function Shown({ children }: { children: React.ReactNode }) {
  return (
    <>
      {children}. <a href="#what-if">Show it</a>
    </>
  )
}
