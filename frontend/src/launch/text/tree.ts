// Parses a campaign's text to a tree with source positions. Reads YAML 1.2 (and thus JSON) as the service does; semantic
// checks are left to the service.
import { Composer, CST, isMap, isScalar, isSeq, type Node, type Pair, Parser, type Scalar, type YAMLMap, type YAMLSeq } from 'yaml'
import type { Json } from '../../api/campaign'

export type Step = string | number
export type At = readonly Step[]
export type Entry = Pair<unknown, unknown>

export interface Parsed {
  root: Node
  /** All of the text, token by token; the nodes name theirs. */
  tokens: CST.Token[]
  /** Written as JSON: insertions must be JSON too. */
  json: boolean
  newline: string
}

/** The text as a tree; null if it cannot be edited in place. */
export function parsed(text: string): Parsed | null {
  const tokens = [...new Parser().parse(text)]
  const [document, more] = new Composer({ keepSourceTokens: true, strict: true, uniqueKeys: true }).compose(tokens, true)
  const root = document?.contents
  if (!document || more || document.errors.length > 0 || !isMap(root)) return null
  return { root, tokens, json: text.trimStart().startsWith('{'), newline: newlineOf(text) }
}

export const newlineOf = (text: string): string => (text.includes('\r\n') ? '\r\n' : '\n')
export const textOf = ({ tokens }: Parsed): string => tokens.map((token) => CST.stringify(token)).join('')

/** Mappings in which a dotted name may be written as nested mappings. */
export const NESTING = new Set<Step | undefined>(['parameters', 'start', 'goal'])

export const keyOf = (pair: Entry): string => (isScalar(pair.key) ? String(pair.key.value) : '')
export const valueOf = (pair: Entry): Node | null => (pair.value as Node | null) ?? null

export interface Found {
  /** Number of resolved steps: all of them if the location exists. */
  steps: number
  node: Node | null
  /** The parent of the node, and its pair if that is a mapping. */
  owner: YAMLMap | YAMLSeq | null
  pair: Entry | null
  index: number
  /** The unresolved rest of a dotted name: `x` of `position.x` if only `position` exists. */
  rest: string | null
}

/** Follows a path as far as it exists in the text. */
export function walk({ root }: Pick<Parsed, 'root'>, at: At): Found {
  let found: Found = { steps: 0, node: root, owner: null, pair: null, index: 0, rest: null }
  for (const [i, step] of at.entries()) {
    const { node } = found
    if (isMap(node)) {
      const hit = lookup(node, String(step), NESTING.has(at[i - 1]))
      if ('rest' in hit) return { ...found, node: hit.owner, rest: hit.rest }
      found = { ...hit, steps: i + 1, node: valueOf(hit.pair), rest: null }
    } else if (isSeq(node)) {
      const item = node.items[Number(step)] as Node | undefined
      if (!item) return found
      found = { steps: i + 1, node: item, owner: node, pair: null, index: Number(step), rest: null }
    } else return found
  }
  return found
}

type Hit = { owner: YAMLMap; pair: Entry; index: number } | { owner: YAMLMap; rest: string }

function lookup(map: YAMLMap, name: string, nesting: boolean): Hit {
  const index = map.items.findIndex((pair) => keyOf(pair) === name)
  const pair = map.items[index]
  if (pair) return { owner: map, pair, index }
  for (const outer of nesting ? map.items : []) {
    const key = `${keyOf(outer)}.`
    if (isMap(outer.value) && name.startsWith(key)) return lookup(outer.value, name.slice(key.length), true)
  }
  return { owner: map, rest: name }
}

/** Start and end of a node's own text, without trailing comments and blank lines. */
export function span(node: Node, text: string): [number, number] {
  const [start, end] = node.range ?? [0, 0]
  if (isMap(node) && !node.flow && node.items.length > 0) return [start, endOf(node.items.at(-1) as Entry, text)]
  if (isSeq(node) && !node.flow && node.items.length > 0) {
    const last = node.items.at(-1) as Node
    return [start, Math.max(span(last, text)[1], dashOf(node, node.items.length - 1) + 1)]
  }
  if (isBlock(node)) return [start, start + text.slice(start, end).trimEnd().length]
  return [start, end]
}

/** Block text after `|` or `>`. */
export const isBlock = (node: unknown): node is Scalar =>
  isScalar(node) && (node.type === 'BLOCK_LITERAL' || node.type === 'BLOCK_FOLDED')

/** End of a pair: after its value, or after its colon if it has none. */
export function endOf(pair: Entry, text: string): number {
  const value = valueOf(pair)
  return Math.max(value ? span(value, text)[1] : 0, colonOf(pair) + 1, startOf(pair))
}

export const startOf = (pair: Entry): number => (pair.key as Node | null)?.range?.[0] ?? 0

/** Position of the colon of a pair, or -1. */
export const colonOf = (pair: Entry): number =>
  pair.srcToken?.sep?.find((token) => token.type === 'map-value-ind')?.offset ?? -1

/** Position of the dash of a list item, or -1. */
const dashOf = (list: YAMLSeq, index: number): number =>
  (list.srcToken as CST.BlockSequence | undefined)?.items[index]?.start.find(({ type }) => type === 'seq-item-ind')?.offset ?? -1

/** The document as plain values; nested names are joined by dots as in the service. */
export const plain = ({ root }: { root: Node | null }): Json => flat(valueIn(root), [])

function valueIn(node: unknown): Json {
  if (isMap(node)) return Object.fromEntries(node.items.map((pair) => [keyOf(pair), valueIn(pair.value)]))
  if (isSeq(node)) return node.items.map(valueIn)
  return isScalar(node) ? (node.value as Json) : null
}

function flat(value: Json, at: At): Json {
  if (Array.isArray(value)) return value.map((inner, i) => flat(inner, [...at, i]))
  if (value === null || typeof value !== 'object') return value
  if (NESTING.has(at.at(-1))) return Object.fromEntries(joined(value, ''))
  return Object.fromEntries(Object.entries(value).map(([key, inner]) => [key, flat(inner, [...at, key])]))
}

function joined(values: { [key: string]: Json }, prefix: string): [string, Json][] {
  return Object.entries(values).flatMap(([key, value]): [string, Json][] =>
    value !== null && typeof value === 'object' && !Array.isArray(value)
      ? joined(value, `${prefix}${key}.`)
      : [[prefix + key, value]],
  )
}
