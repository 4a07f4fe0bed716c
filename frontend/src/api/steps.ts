// The next steps that the failing checks of a verdict offer.
import type { DescribedCheck, Remedy, Span } from '../client'

export interface Step {
  /** Its place among the checks, for the address of the launch page: `validation.0`. */
  key: string
  remedy: Remedy
}

/** The remedies of all checks; those that change the same values are offered once. */
export function stepsOf(checks: readonly Pick<DescribedCheck, 'name' | 'remedies'>[]): Step[] {
  const taken = new Set<string>()
  return checks.flatMap((check) =>
    check.remedies.flatMap((remedy, i) => {
      const places = JSON.stringify(remedy.changes.map(({ at }) => at))
      if (taken.has(places)) return []
      taken.add(places)
      return [{ key: `${check.name}.${i}`, remedy }]
    }),
  )
}

/** The steps that an address of the launch page names; unknown ones are omitted. */
export function stepsIn(named: string, checks: readonly Pick<DescribedCheck, 'name' | 'remedies'>[]): Step[] {
  const keys = named.split(',')
  return stepsOf(checks).filter(({ key }) => keys.includes(key))
}

export const keysOf = (steps: readonly Step[]): string => steps.map(({ key }) => key).join(',')

/** What several steps change, in one phrase. */
export const statementOf = (steps: readonly Step[]): Span[] =>
  steps.flatMap(({ remedy }, i) => [...(i > 0 ? [{ kind: 'text' as const, text: ', ' }] : []), ...remedy.statement])
