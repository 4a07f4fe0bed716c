// Opens and closes the what-if.
import { IconAdjustments } from '@tabler/icons-react'
import { useBarred } from '../../api/may'
import type { WhatIfState } from './useWhatIf'
import { Button } from '../../ui/Button'

interface Props {
  whatIf: Pick<WhatIfState, 'whatIf' | 'toggle'>
  /** Whether a scenario is simulated; a simulator may take long. */
  flies: boolean
}

export function WhatIfButton({ whatIf, flies }: Props) {
  const barred = useBarred('engineer')
  return (
    <Button
      small
      barred={barred}
      icon={IconAdjustments}
      aria-pressed={whatIf.whatIf !== null}
      title={flies ? 'Other parameters, simulated at once' : 'Other parameters, evaluated on request'}
      onClick={whatIf.toggle}
    >
      What-if
    </Button>
  )
}
