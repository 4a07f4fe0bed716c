// The name of a parameter on the pages: its symbol, with its part of the campaign where others have the same symbol. Files
// contain its path. The same names as in `campaigns/symbols.py`.

/** Separates the symbol from the part it belongs to; no symbol has a space. */
const OF = ' of '
/** The path of a criterion's threshold. */
const THRESHOLD = /^(criterion|objectives\.\d+)\.threshold$/
const PARTS = ['vehicle', 'controller', 'avoider', 'start', 'goal', 'criterion']
const LISTS: Record<string, string> = {
  obstacles: 'obstacle',
  environment: 'environment',
  faults: 'fault',
  objectives: 'further criterion',
}

/**
 * A name for each path; symbols: of all parameters of the campaign, by path, empty for those without one.
 *
 * A threshold is a field of the campaign, and no catalogue has it: its symbol is shown nowhere, and counts nowhere.
 */
export function namesOf(paths: readonly string[], symbols: ReadonlyMap<string, string>): Map<string, string> {
  const shown = [...symbols.keys()].filter((path) => paths.includes(path) || !THRESHOLD.test(path))
  const all = new Map([...paths, ...shown].map((path) => [path, symbols.get(path) || lastOf(path)]))
  const counted = tally([...all.values()])
  const names = new Map([...all].map(([path, symbol]) => [path, counted.get(symbol) === 1 ? symbol : nameOf(path, symbol)]))
  // Two parameters of one part may have the same symbol.
  const shared = tally([...names.values()])
  return new Map(paths.map((path) => [path, shared.get(names.get(path) ?? '') === 1 ? (names.get(path) ?? path) : path]))
}

/** The symbol with the part of the campaign that the path is in; the path where that part has no name. */
export function nameOf(path: string, symbol = lastOf(path)): string {
  const [part = '', number = ''] = path.split('.')
  const listed = LISTS[part]
  if (listed !== undefined && /^\d+$/.test(number)) return `${symbol}${OF}${listed} ${Number(number) + 1}`
  return PARTS.includes(part) ? `${symbol}${OF}the ${part}` : path
}

/** The symbol of a name and the rest of it, which is upright in print: `y` and ` of obstacle 1`. */
export function apart(name: string): [string, string] {
  const at = name.indexOf(OF)
  return at < 0 ? [name, ''] : [name.slice(0, at), name.slice(at)]
}

export const lastOf = (path: string): string => path.split('.').at(-1) ?? path

/** How often each of these occurs, in the order in which they first do. */
export function tally<T>(words: readonly T[]): Map<T, number> {
  const found = new Map<T, number>()
  for (const word of words) found.set(word, (found.get(word) ?? 0) + 1)
  return found
}
