// The service's problems next to their fields, looked up by the service's field name.
import { IconAlertCircle } from '@tabler/icons-react'
import { createContext, useContext } from 'react'
import type { FieldProblem } from '../../api/problems'
import { fields as fieldsCss } from '../../ui/styles'

const Problems = createContext<readonly FieldProblem[]>([])

export const ProblemsProvider = Problems.Provider

const within = (field: string, problem: FieldProblem): boolean =>
  problem.field === field || problem.field.startsWith(`${field}.`)

/** The number of problems of some fields and everything below them. */
export function useTroubled(fields: readonly string[]): number {
  const all = useContext(Problems)
  return all.filter((problem) => fields.some((field) => within(field, problem))).length
}

/** The problems of a field, or of everything below it. */
export function useProblems(field: string, deep = false): FieldProblem[] {
  const all = useContext(Problems)
  return all.filter((problem) => (deep ? within(field, problem) : problem.field === field))
}

/** An identifier of an element for a field. */
export const idOf = (field: string): string => `f-${field.replace(/[^\w-]/g, '-')}`

export function Message({ problem: { field, message } }: { problem: FieldProblem }) {
  return (
    <p className={fieldsCss.ferr} data-problem={field}>
      <IconAlertCircle className="i" aria-hidden />
      <span>{message.charAt(0).toUpperCase() + message.slice(1)}</span>
    </p>
  )
}

export function FieldErrors({ field, deep }: { field: string; deep?: boolean }) {
  const problems = useProblems(field, deep)
  return problems.map((problem) => <Message key={problem.field + problem.message} problem={problem} />)
}

/** Scrolls to and focuses the field of a problem, or its nearest parent on the page. */
export function focusField(field: string): void {
  const parts = field.split('.')
  for (let length = parts.length; length > 0; length--) {
    const element = document.getElementById(idOf(parts.slice(0, length).join('.')))
    if (!element) continue
    for (let fold = element.closest('details'); fold; fold = fold.parentElement?.closest('details') ?? null) fold.open = true
    element.scrollIntoView({ block: 'center' })
    element.focus({ preventScroll: true })
    return
  }
}
