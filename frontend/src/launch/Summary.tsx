// All problems that prevent a run from starting; each entry links to its field.
import { clsx } from 'clsx'
import { IconAlertTriangle } from '@tabler/icons-react'
import type { FieldProblem } from '../api/problems'
import { Button, TextButton } from '../ui/Button'
import { cards } from '../ui/styles'
import styles from './launch.module.css'

interface SummaryProps {
  problems: readonly FieldProblem[]
  trouble: Error | null
  /** Where the trouble is a check that failed. */
  recheck: (() => void) | null
  tab: 'form' | 'yaml'
  onForm: (field: string) => void
  onText: (field: string) => void
}

export function Summary({ problems, trouble, recheck, tab, onForm, onText }: SummaryProps) {
  if (problems.length === 0 && !trouble) return null
  const [here, there] = tab === 'form' ? [onForm, onText] : [onText, onForm]
  return (
    <div className={clsx(cards.note, cards.bad)} id="problems" role="alert">
      <IconAlertTriangle className="i" aria-hidden />
      <div>
        <span className="b">
          {trouble
            ? `${recheck ? 'The campaign could not be checked. ' : ''}${trouble.message}`
            : problems.length === 1
              ? 'One problem prevents this run from starting'
              : `${problems.length} problems prevent this run from starting`}
        </span>
        {recheck && (
          <div className={styles.recheck}>
            <Button small onClick={recheck}>Try again</Button>
          </div>
        )}
        <ul>
          {problems.slice(0, 12).map((problem) => (
            <li key={problem.field + problem.message}>
              {problem.field && (
                <span className={styles.where}>
                  <TextButton className="mono" onClick={() => here(problem.field)}>{problem.field}</TextButton>
                  <TextButton className="small" onClick={() => there(problem.field)}>
                    {tab === 'form' ? 'In the YAML' : 'In the form'}
                  </TextButton>
                </span>
              )}
              {problem.message.charAt(0).toUpperCase() + problem.message.slice(1)}
              {problem.given && <span className="mut"> (given {problem.given})</span>}
            </li>
          ))}
        </ul>
      </div>
    </div>
  )
}
