// How a case came out when it was simulated again, in words.
import type { ValidationCase } from '../../api/results'

/** `agrees` and `violates` are newer than `ok`. */
export function validatedWord({ ok, agrees, violates }: Partial<ValidationCase>): string {
  if (agrees === undefined || violates === undefined) return ok ? 'Validated' : 'Not validated'
  if (violates) return agrees ? 'Violation confirmed' : 'Violation confirmed, beyond tolerance'
  return agrees ? 'Integrations agree' : 'Integrations disagree'
}
