// The minimal changes of an edit in the form, so that only the affected text is changed.
import { type Json, read, write } from '../../api/campaign'
import type { At } from './tree'
import { isMapping } from './words'

export type Change =
  /** `before` lists the keys that precede a new one in a complete campaign. */
  | { kind: 'set'; at: At; value: Json; before: string[] }
  | { kind: 'remove'; at: At }
  | { kind: 'insert'; at: At; value: Json }
  | { kind: 'rename'; at: At; to: string }

/** The changes from one document to the other. */
export function changesOf(from: unknown, to: unknown, at: At = []): Change[] {
  if (isMapping(from) && isMapping(to)) return mapped(from, to, at)
  if (Array.isArray(from) && Array.isArray(to)) return listed(from as Json[], to as Json[], at)
  return equal(from, to) ? [] : [{ kind: 'set', at, value: terse(to as Json), before: [] }]
}

/** Fields in which null removes a default; elsewhere null equals absence. */
const speaks = (at: At, key: string): boolean => at.includes('options') || (at[0] === 'stages' && (key === 'sensitivity' || key === 'certify'))

/** The service reorders these lists, so that indices differ from those in the text. */
const WHOLE = new Set(['between', 'tags'])

function mapped(from: { [key: string]: Json | undefined }, to: { [key: string]: Json | undefined }, at: At): Change[] {
  const gone = (values: typeof from, key: string) =>
    values[key] === undefined || (values[key] === null && !speaks(at, key))
  const changes: Change[] = Object.keys(from)
    .filter((key) => !gone(from, key) && gone(to, key))
    .map((key) => ({ kind: 'remove', at: [...at, key] }))
  const keys = Object.keys(to)
  for (const [i, key] of keys.entries()) {
    if (gone(to, key)) continue
    const [old, value] = [from[key], to[key] as Json]
    if (gone(from, key) || old === null || WHOLE.has(key) || isMapping(old) !== isMapping(value) || Array.isArray(old) !== Array.isArray(value)) {
      if (!equal(old, value)) changes.push({ kind: 'set', at: [...at, key], value: terse(value), before: keys.slice(0, i) })
    } else if (isMapping(value) || Array.isArray(value)) changes.push(...changesOf(old, value, [...at, key]))
    else if (!equal(old, value)) changes.push({ kind: 'set', at: [...at, key], value, before: keys.slice(0, i) })
  }
  return changes
}

function listed(from: Json[], to: Json[], at: At): Change[] {
  const least = Math.min(from.length, to.length)
  let head = 0
  while (head < least && equal(from[head], to[head])) head++
  let tail = 0
  while (tail < least - head && equal(from.at(-1 - tail), to.at(-1 - tail))) tail++
  const [olds, news] = [from.length - head - tail, to.length - head - tail]
  const shared = Math.min(olds, news)
  const changes: Change[] = []
  for (let i = 0; i < shared; i++) changes.push(...changesOf(from[head + i], to[head + i], [...at, head + i]))
  for (let i = olds - 1; i >= shared; i--) changes.push({ kind: 'remove', at: [...at, head + i] })
  for (let i = shared; i < news; i++)
    changes.push({ kind: 'insert', at: [...at, head + i], value: terse(to[head + i] as Json) })
  return changes
}

/** Keys without meaning while empty. */
const EMPTY = new Set(['parameters', 'options', 'starts', 'at', 'source', 'on', 'low', 'high', 'plus_minus', 'unit'])

/** A value without empty and default entries. */
function terse(value: Json): Json {
  if (Array.isArray(value)) return value.map(terse)
  if (!isMapping(value)) return value
  return Object.fromEntries(
    Object.entries(value).flatMap(([key, inner]) => {
      if (inner === undefined || (EMPTY.has(key) && isEmpty(inner))) return []
      if (key === 'distribution' && isMapping(inner) && inner.kind === 'uniform') return []
      return [[key, terse(inner)]]
    }),
  )
}

const isEmpty = (value: Json): boolean =>
  value === null || value === '' || (typeof value === 'object' && Object.keys(value).length === 0)

/** The document after a change. Missing parents are created. */
export function applied(document: Json, change: Change): Json {
  if (change.kind === 'set') return write(document, change.at, change.value)
  const [above, key] = [change.at.slice(0, -1), change.at.at(-1)]
  const found = read(document, above) as Json | undefined
  const listed = Array.isArray(found) ? found : []
  if (change.kind === 'insert') return write(document, above, listed.toSpliced(Number(key), 0, change.value))
  if (Array.isArray(found)) return write(document, above, listed.toSpliced(Number(key), 1))
  if (!isMapping(found)) return document
  const pairs = Object.entries(found)
  const left = change.kind === 'rename' ? pairs.map(([name, v]) => [name === key ? change.to : name, v]) : pairs.filter(([name]) => name !== key)
  return write(document, above, Object.fromEntries(left) as Json)
}

/** Whether two values are equal, ignoring the order of keys. */
export function equal(a: unknown, b: unknown): boolean {
  if (a === b) return true
  if (Array.isArray(a) && Array.isArray(b)) return a.length === b.length && a.every((one, i) => equal(one, b[i]))
  if (!isMapping(a) || !isMapping(b)) return false
  const keys = Object.keys(a)
  return keys.length === Object.keys(b).length && keys.every((key) => key in b && equal(a[key], b[key]))
}
