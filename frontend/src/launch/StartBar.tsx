// At the lower edge of the window wherever the page is scrolled: the estimated effort, and the start of the run.
import { IconPlayerPlay } from '@tabler/icons-react'
import { clsx } from 'clsx'
import type { Checked } from '../client'
import { Button } from '../ui/Button'
import { amountOf, timeOf } from './estimate'
import { buttons, layout } from '../ui/styles'
import styles from './launch.module.css'

interface StartBarProps {
  /** Undefined until the first answer. */
  checked: Checked | undefined
  /** Whether the estimate belongs to an earlier state of the campaign. */
  checking: boolean
  failed: boolean
  disabled: boolean
  busy: boolean
  /** Why it cannot be started; empty otherwise. */
  why: string
  onStart: () => void
}

export function StartBar({ checked, checking, failed, disabled, busy, why, onStart }: StartBarProps) {
  return (
    <div className={clsx(layout.row, styles.bar)} role="region" aria-label="Start">
      <div className={clsx(layout.grow, styles.effort)}>
        <p aria-busy={checking} data-testid="effort">
          {effortOf(checked, failed)}
        </p>
        <p className="small mut" aria-live="polite">
          {why}
        </p>
      </div>
      <Button main icon={IconPlayerPlay} disabled={disabled || busy} onClick={onStart}>
        {busy ? 'Starting …' : 'Start run'}
        <span className={buttons.kbd}>Ctrl ↵</span>
      </Button>
    </div>
  )
}

/** Evaluations: at most 22 300. Time: about 6.1 s, about 11 s with all evaluations. */
export function effortOf(checked: Checked | undefined, failed: boolean): string {
  const { estimate } = checked ?? {}
  if (!estimate && failed) return 'No estimate: the campaign could not be checked'
  if (!estimate) return checked && !checked.ok ? 'No estimate while there are problems' : 'Estimating …'
  const time = timeOf(estimate)
  return `Evaluations: ${amountOf(estimate)}. Time: ${time ?? 'not known'}`
}
