// All that keeps a run from starting, in one place; each entry leads to its field.
import { IconAlertTriangle } from '@tabler/icons-react'
import type { FieldProblem } from '../api/problems'
import { focusField } from './problems'

interface SummaryProps {
  problems: readonly FieldProblem[]
  trouble: Error | null
  onForm: () => void
}

export function Summary({ problems, trouble, onForm }: SummaryProps) {
  if (problems.length === 0 && !trouble) return null
  const go = (field: string) => {
    onForm()
    requestAnimationFrame(() => focusField(field))
  }
  return (
    <div className="note bad" id="problems" role="alert">
      <IconAlertTriangle className="i" aria-hidden />
      <div>
        <span className="b">
          {trouble
            ? trouble.message
            : problems.length === 1
              ? 'One thing keeps this run from starting'
              : `${problems.length} things keep this run from starting`}
        </span>
        <ul>
          {problems.slice(0, 12).map((problem) => (
            <li key={problem.field + problem.message}>
              {problem.field && (
                <button type="button" className="linkbtn mono" onClick={() => go(problem.field)}>
                  {problem.field}
                </button>
              )}{' '}
              {problem.message}
              {problem.given && <span className="mut"> (given {problem.given})</span>}
            </li>
          ))}
        </ul>
      </div>
    </div>
  )
}
