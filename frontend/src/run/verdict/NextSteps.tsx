// What may be tried next after an inconclusive verdict: each step opens the launch page with the campaign changed.
import { IconRefresh } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { keysOf, stepsOf } from '../../api/steps'
import type { RunDetail } from '../../client'
import { ButtonLink } from '../../ui/Button'
import { Spans } from '../../ui/Spans'
import { layout } from '../../ui/styles'
import styles from './verdict.module.css'

export function NextSteps({ run }: { run: RunDetail }) {
  const steps = stepsOf(run.summary?.checks ?? [])
  if (steps.length === 0) return null
  return (
    <div className={clsx(layout.row, styles.next)} role="group" aria-label="Next steps">
      {steps.map((step) => (
        <ButtonLink key={step.key} small icon={IconRefresh} to="/launch" search={{ from: run.id, remedy: step.key }}>
          <span>
            Run again <Spans spans={step.remedy.statement} />
          </span>
        </ButtonLink>
      ))}
      {steps.length > 1 && (
        <ButtonLink small to="/launch" search={{ from: run.id, remedy: keysOf(steps) }}>
          {steps.length === 2 ? 'With both' : `With all ${steps.length}`}
        </ButtonLink>
      )}
    </div>
  )
}
