// Which parts of a run could not be loaded. A part that is missing must not look like one that is empty.

export interface MissingPart {
  /** In the words of the page: `findings`. */
  name: string
  error: Error
  retry: () => void
}

interface Request {
  isError: boolean
  data: unknown
  error: Error | null
  refetch: () => unknown
}

/** The parts whose request has failed for good and that were never loaded before. */
export function missingOf(requests: Readonly<Record<string, Request>>): MissingPart[] {
  return Object.entries(requests).flatMap(([name, { isError, data, error, refetch }]) =>
    isError && data === undefined && error !== null ? [{ name, error, retry: () => void refetch() }] : [],
  )
}

/** Whether the same parts are missing for the same reasons. */
export const isSame = (before: readonly MissingPart[], now: readonly MissingPart[]): boolean =>
  before.length === now.length && before.every(({ name, error }, i) => now[i]?.name === name && now[i].error === error)

/** `stages, findings and evaluations`. */
export const listed = (parts: readonly Pick<MissingPart, 'name'>[]): string => new Intl.ListFormat('en-GB').format(parts.map(({ name }) => name))

/** In place of a part that is not there: it is still being loaded, or could not be. */
export function insteadOf(missing: readonly Pick<MissingPart, 'name'>[], name: string): string {
  return missing.some((part) => part.name === name) ? `The ${name} could not be loaded.` : `Loading the ${name} …`
}
