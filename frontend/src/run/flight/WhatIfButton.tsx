// Opens and closes the what-if.
import { clsx } from 'clsx'
import { IconAdjustments } from '@tabler/icons-react'
import type { WhatIfState } from './useWhatIf'
import buttons from '../../ui/buttons.module.css'

interface Props {
  whatIf: Pick<WhatIfState, 'whatIf' | 'toggle'>
  /** Whether a scenario is simulated; a simulator may take long. */
  flies: boolean
}

export function WhatIfButton({ whatIf, flies }: Props) {
  return (
    <button
      type="button"
      className={clsx(buttons.btn, buttons.s)}
      aria-pressed={whatIf.whatIf !== null}
      title={flies ? 'Other parameters, simulated at once' : 'Other parameters, evaluated on request'}
      onClick={whatIf.toggle}
    >
      <IconAdjustments className="i s" aria-hidden /> What-if
    </button>
  )
}
