// What may be tried next after an inconclusive verdict: each step opens the launch page with the campaign changed.
import { clsx } from 'clsx'
import { IconRefresh } from '@tabler/icons-react'
import { Link } from '@tanstack/react-router'
import { keysOf, stepsOf } from '../../api/steps'
import type { RunDetail } from '../../client'
import { Spans } from '../../ui/Spans'
import buttons from '../../ui/buttons.module.css'
import styles from './verdict.module.css'

export function NextSteps({ run }: { run: RunDetail }) {
  const steps = stepsOf(run.summary?.checks ?? [])
  if (steps.length === 0) return null
  return (
    <div className={styles.next} role="group" aria-label="Next steps">
      {steps.map((step) => (
        <Link key={step.key} to="/launch" search={{ from: run.id, remedy: step.key }} className={clsx(buttons.btn, buttons.s)}>
          <IconRefresh className="i s" aria-hidden />
          <span>
            Run again <Spans spans={step.remedy.statement} />
          </span>
        </Link>
      ))}
      {steps.length > 1 && (
        <Link to="/launch" search={{ from: run.id, remedy: keysOf(steps) }} className={clsx(buttons.btn, buttons.s)}>
          {steps.length === 2 ? 'With both' : `With all ${steps.length}`}
        </Link>
      )}
    </div>
  )
}
