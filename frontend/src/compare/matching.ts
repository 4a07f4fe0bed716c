// Matches findings of several runs by their positions within common bounds.
import { type Campaign, LISTS } from '../api/campaign'
import type { FindingDetail } from '../client'
import type { Compared } from './data'

/** Maximum difference of each parameter between matching findings, as a fraction of its range. */
export const APART = 0.1

export type Searched = Pick<Compared, 'findings' | 'parameters' | 'parts'>

/** An obstacle, disturbance or fault: its component, and its stated values by the path below it, null if varied. */
type Part = { component: string; values: Map<string, string | null> }
/** By the prefix of their paths, which are positions in a list, where another campaign may have another part. */
export type Parts = Record<string, Part>

export function partsOf(campaign: Campaign, paths: readonly string[]): Parts {
  const parts = LISTS.flatMap((name) =>
    (campaign.scenario?.[name] ?? []).map((part, i): [string, Part] => {
      const below = `${name}.${i}.`
      const varied = paths.filter((path) => path.startsWith(below)).map((path): [string, null] => [path.slice(below.length), null])
      const component = `${part.component} ${part.on ?? ''}`
      const values = new Map<string, string | null>([...valuesOf(part.parameters ?? {}), ...varied])
      return [`${name}.${i}`, { component, values }]
    }),
  )
  return Object.fromEntries(parts)
}

/** Values by path, of parameters that may be nested. */
function valuesOf(values: object, above = ''): [string, string][] {
  return Object.entries(values).flatMap(([name, value]: [string, unknown]): [string, string][] =>
    typeof value === 'object' && value !== null ? valuesOf(value, `${above}${name}.`) : [[`${above}${name}`, String(value)]],
  )
}

/** How many values of two parts differ that neither campaign varies; infinite for other components. */
function differing(a: Part, b: Part): number {
  if (a.component !== b.component) return Number.POSITIVE_INFINITY
  const names = new Set([...a.values.keys(), ...b.values.keys()])
  const fixed = [...names].filter((name) => a.values.get(name) !== null && b.values.get(name) !== null)
  return fixed.filter((name) => a.values.get(name) !== b.values.get(name)).length
}

/** Whether every part of which something varies is the same one in both, or was changed: then no other part there is closer. */
function sameParts(a: Parts, b: Parts): boolean {
  return Object.entries(a).every(([prefix, part]) => {
    if (![...part.values.values()].includes(null)) return true
    const there = b[prefix]
    if (!there) return false
    const own = differing(part, there)
    const others = Object.entries(b).filter(([other]) => other.split('.')[0] === prefix.split('.')[0])
    return own < Number.POSITIVE_INFINITY && others.every(([, other]) => own <= differing(part, other))
  })
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
    if (!sameParts(first.parts, parts) || !sameParts(parts, first.parts)) return null
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
