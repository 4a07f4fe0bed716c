// The problems of the text by line, with links to the line and to the field in the form.
import { IconAlertCircle } from '@tabler/icons-react'
import type { Placed } from './setup'
import { TextButton } from '../../ui/Button'
import styles from './code.module.css'

interface ProblemListProps {
  placed: readonly Placed[]
  onGo: (from: number, to: number) => void
  onForm: (field: string) => void
}

const MOST = 50

export function ProblemList({ placed, onGo, onForm }: ProblemListProps) {
  if (placed.length === 0) return null
  const sorted = [...placed].sort((a, b) => a.from - b.from).slice(0, MOST)
  return (
    <ol className={styles.codeproblems} aria-label="Problems">
      {sorted.map(({ problem, from, to, line }) => (
        <li key={problem.field + problem.message} data-problem={problem.field}>
          <IconAlertCircle className="i bad-t" aria-hidden />
          <TextButton className="nw" onClick={() => onGo(from, to)}>Line {line}</TextButton>
          <span>
            {!problem.field.startsWith('line ') && problem.field && <span className="mono">{problem.field} </span>}
            {problem.message}
            {problem.given && <span className="mut"> (given {problem.given})</span>}
          </span>
          {problem.field && !problem.field.startsWith('line ') && (
            <TextButton className="nw" aria-label={`Show ${problem.field} in the form`} onClick={() => onForm(problem.field)}>
              In the form
            </TextButton>
          )}
        </li>
      ))}
    </ol>
  )
}
