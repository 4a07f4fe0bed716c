// Encodes a page's state in its address: plain text, repeated keys for lists.

/** Parses the query of an address: strings, lists for repeated keys. */
export function parseSearch(text: string): Record<string, unknown> {
  const found: Record<string, unknown> = {}
  for (const [key, value] of new URLSearchParams(text.replace(/^\?/, ''))) {
    const before = found[key]
    if (before === undefined) found[key] = value
    else if (Array.isArray(before)) before.push(value)
    else found[key] = [before, value]
  }
  return found
}

const written = (value: unknown): string => (typeof value === 'string' ? value : JSON.stringify(value))

export function stringifySearch(search: Record<string, unknown>): string {
  const query = new URLSearchParams()
  for (const [key, value] of Object.entries(search)) {
    if (value === undefined || value === null) continue
    if (!Array.isArray(value)) query.append(key, written(value))
    else if (value.length === 0) query.append(key, '')
    else for (const item of value) query.append(key, written(item))
  }
  // Commas and colons need no escaping and are more readable without it.
  const text = query.toString().replaceAll('%2C', ',').replaceAll('%3A', ':')
  return text ? `?${text}` : ''
}

/** Wraps a page's parser so that unknown keys are dropped: the router would pass them on. */
export const onlyKnown =
  <T extends object>(read: (search: Record<string, unknown>) => T) =>
  (search: Record<string, unknown>): T => ({
    ...Object.fromEntries(Object.keys(search).map((key) => [key, undefined])),
    ...read(search),
  })
