// Matches findings of several runs by their positions within common bounds.
import type { Campaign } from '../api/campaign'
import type { FindingDetail } from '../client'
import type { Compared } from './data'

/** Maximum difference of each parameter between matching findings, as a fraction of its range. */
export const APART = 0.1

export type Searched = Pick<Compared, 'findings' | 'parameters' | 'parts'>

/**
 * The obstacles, disturbances and faults of which something varies, as the campaign states them but for what varies: their
 * paths are positions in a list, where another campaign may have another part.
 */
export function partsOf(campaign: Campaign, paths: readonly string[]): string {
  const varied = new Set(paths.map((path) => /^(obstacles|environment|faults)\.(\d+)\./.exec(path)?.slice(1, 3).join('.') ?? ''))
  const lists = ['obstacles', 'environment', 'faults'] as const
  const parts = lists.flatMap((name) =>
    (campaign.scenario?.[name] ?? []).flatMap((part, i) => {
      const prefix = `${name}.${i}`
      return varied.has(prefix) ? [[prefix, part.component, part.on ?? '', ...fixedOf(prefix, part.parameters ?? {}, paths)]] : []
    }),
  )
  return JSON.stringify(parts)
}

/** The values by path that are not varied, of parameters that may be nested. */
function fixedOf(prefix: string, values: object, paths: readonly string[]): string[] {
  return Object.entries(values)
    .flatMap(([name, value]: [string, unknown]) => {
      const path = `${prefix}.${name}`
      if (typeof value === 'object' && value !== null) return fixedOf(path, value, paths)
      return paths.includes(path) ? [] : [`${path}=${String(value)}`]
    })
    .sort()
}

/** One distinct worst case, in each run that has it. */
export type Case = (FindingDetail | null)[]

/**
 * The cases of all runs, the worst of the first run first; those of other runs alone behind them. Null where the runs do
 * not vary the same parameters of the same parts: then a place in one is none in the other.
 */
export function matched(runs: readonly Searched[]): Case[] | null {
  const ranges = rangesOf(runs)
  if (ranges === null) return null
  const cases: Case[] = []
  runs.forEach(({ findings }, i) => {
    const pairs = findings
      .flatMap((finding) => cases.map((one, at) => ({ finding, at, apart: fromAny(one, finding, ranges) })))
      .filter(({ at, apart }) => apart <= APART && cases[at]?.[i] === null)
      .sort((a, b) => a.apart - b.apart)
    const placed = new Set<FindingDetail>()
    for (const { finding, at } of pairs) {
      const one = cases[at]
      if (!one || one[i] !== null || placed.has(finding)) continue
      one[i] = finding
      placed.add(finding)
    }
    for (const finding of findings)
      if (!placed.has(finding)) cases.push(runs.map((_, k) => (k === i ? finding : null)))
  })
  return cases
}

type Ranges = Map<string, number>

/** The range of each parameter over all runs; null if they vary different ones. */
function rangesOf(runs: readonly Searched[]): Ranges | null {
  const ends = new Map<string, [number, number]>()
  const [first] = runs
  if (!first) return null
  for (const { parameters, parts } of runs) {
    if (parts !== first.parts) return null
    if (parameters.length !== first.parameters.length) return null
    for (const { path, low, high } of parameters) {
      const [a, b] = ends.get(path) ?? [low, high]
      ends.set(path, [Math.min(a, low), Math.max(b, high)])
    }
  }
  if (ends.size !== first.parameters.length) return null
  return new Map([...ends].map(([path, [low, high]]) => [path, high - low]))
}

const fromAny = (one: Case, finding: FindingDetail, ranges: Ranges): number =>
  Math.min(...one.map((other) => (other ? between(other, finding, ranges) : Number.POSITIVE_INFINITY)))

function between(a: FindingDetail, b: FindingDetail, ranges: Ranges): number {
  const apart = [...ranges].map(([path, range]) => {
    const [x, y] = [a.parameters[path], b.parameters[path]]
    return x === undefined || y === undefined ? Number.POSITIVE_INFINITY : Math.abs(x - y) / (range || 1)
  })
  return Math.max(0, ...apart)
}
