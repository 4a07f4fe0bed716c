// Below the verdict of a run that evaluates a simulator: what it does not show, and why a case has no trace.
import { clsx } from 'clsx'
import { calledOf, NOMINAL } from '../data/chosen'
import type { RunData } from '../data/data'
import { sceneOf } from './declared'
import type { WhatIfState } from './useWhatIf'
import { WhatIfButton } from './WhatIfButton'
import { at } from '../../format/root'
import { cards, layout } from '../../ui/styles'

/** The reasons why cases have no trace, by name; the nominal one first. */
export function untracedOf(data: Pick<RunData, 'stages'>): [string, string][] {
  // Omitted from the results if there are none.
  return data.stages.flatMap(({ result }) => (result && 'untraced' in result ? Object.entries(result.untraced ?? {}) : []))
}

interface Props {
  data: RunData
  /** The what-if, where no other card opens it. */
  whatIf?: Pick<WhatIfState, 'whatIf' | 'toggle'> | null
}

export function Untraced({ data, whatIf = null }: Props) {
  const reasons = untracedOf(data)
  const { untraced } = data.run // names every reason
  const shown = reasons.filter(([name]) => !untraced && (name === NOMINAL || name === data.chosen))
  const scene = sceneOf(data)
  return (
    <div className={clsx(cards.note, layout.c12)} id="trace">
      {scene ? (
        `This run evaluates a simulator. The 3D view shows what its trace declares, z ${scene.frame === 'z_up' ? 'up' : 'down'}: positions from its columns, obstacles as stated.`
      ) : (
        untraced || (
          <>
            This run evaluates a simulator: there is no 3D view. <Declare />
          </>
        )
      )}
      {whatIf && (
        <p>
          <WhatIfButton whatIf={whatIf} flies={false} />
        </p>
      )}
      {shown.map(([name, reason]) => (
        <p key={name}>
          No trace of {name === NOMINAL ? 'the nominal case' : calledOf(data)}: {reason}.
        </p>
      ))}
    </div>
  )
}

/** What an operator adds for a 3D view. */
export function Declare() {
  return (
    <span>
      For a 3D view, its descriptor or decorator states under <code>scene</code> which columns of the trace are positions, and
      whether z is up or down: see{' '}
      <a href={at('/help/guides/your-own-simulator')}>the guide</a>.
    </span>
  )
}
