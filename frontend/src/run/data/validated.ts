// The validated cases, nominal and findings, and their results as text.
import type { FindingDetail, Validation } from '../../client'

/** `agrees` and `violates` are newer than `ok`. */
export function validatedWord({
  ok,
  agrees,
  violates,
  again,
  repeats,
}: Pick<Validation, 'ok' | 'agrees' | 'violates' | 'again'> & { repeats?: Validation['repeats'] }): string {
  if (repeats) return sentenceCase(repeats.text)
  if (agrees === null || violates === null) return ok ? 'Validated' : 'Not validated'
  if (violates) return agrees ? 'Violation confirmed' : 'Violation confirmed, beyond tolerance'
  if (again) return agrees ? 'Evaluations agree' : 'Evaluations disagree'
  return agrees ? 'Integrations agree' : 'Integrations disagree'
}

const sentenceCase = (text: string) => text.charAt(0).toUpperCase() + text.slice(1)

/** The nominal case, then the findings; without those that earlier versions did not store. */
export const casesOf = (
  { nominal }: { nominal: Validation | null },
  findings: readonly Pick<FindingDetail, 'validation'>[],
): Validation[] => [nominal, ...findings.map(({ validation }) => validation)].flatMap((item) => item ?? [])
