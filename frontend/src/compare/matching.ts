// Matches findings of several runs by their positions within common bounds.
import type { FindingDetail } from '../client'
import type { Compared } from './data'

/** Maximum difference of each parameter between matching findings, as a fraction of its range. */
export const APART = 0.1

export type Searched = Pick<Compared, 'findings' | 'parameters'>

/** One distinct worst case, in each run that has it. */
export type Case = (FindingDetail | null)[]

/**
 * The cases of all runs, the worst of the first run first; those of other runs alone behind them. Null where the runs do
 * not vary the same parameters: then a place in one is none in the other.
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
  for (const { parameters } of runs) {
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
