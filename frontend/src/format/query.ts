// Values in the query of an address, which anybody may have written.

/** A word; a number stands for its digits. */
export const text = (value: unknown): string | undefined =>
  typeof value === 'string' || typeof value === 'number' ? String(value) || undefined : undefined

/** Whether a key is set: true in a link of a page, a word in an address. */
export const flag = (value: unknown): true | undefined => value === true || value === 'true' || undefined

/** One or several words; an empty list does not filter. */
export function words(value: unknown): string[] | undefined {
  const found = (Array.isArray(value) ? value : [value]).flatMap((item) => text(item) ?? [])
  return found.length ? [...new Set(found)] : undefined
}

/** Those that can be labels, key=value. */
export const pairs = (value: unknown): unknown[] =>
  (Array.isArray(value) ? value : [value]).filter((item) => typeof item === 'string' && /^[^=]+=./.test(item))
