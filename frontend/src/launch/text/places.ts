// Maps a field to its position in the text, and a position to its field. Start: `placeOf`, `fieldAt`.
import { isMap, isScalar, isSeq, type Node, parseDocument } from 'yaml'
import { type At, colonOf, endOf, keyOf, NESTING, span, startOf, type Step, valueOf } from './tree'

export interface Tree {
  text: string
  root: Node | null
}

/** The text as a tree, as far as it can be parsed. */
export const tolerant = (text: string): Tree => ({
  text,
  root: parseDocument(text, { keepSourceTokens: true, strict: false, uniqueKeys: false, logLevel: 'silent' }).contents,
})

/** The text range of a field by its service name, or of its nearest existing parent. */
export function placeOf({ text, root }: Tree, field: string): [number, number] {
  const position = /^line (\d+)(?:, column (\d+))?$/.exec(field)
  if (position) return lineOf(text, Number(position[1]), Number(position[2] ?? 1))
  let place: [number, number] = [0, Math.max(0, text.search(/\r?\n|$/))]
  let words = field.split('.').filter(Boolean)
  let node = root
  while (words.length > 0) {
    if (isSeq(node)) {
      const item = node.items[Number(words[0])] as Node | undefined
      if (!item) return place
      place = firstLine(text, span(item, text))
      ;[node, words] = [item, words.slice(1)]
    } else if (isMap(node)) {
      // Names may contain dots: the longest existing one is used.
      const hits = node.items.filter((pair) => `${words.join('.')}.`.startsWith(`${keyOf(pair)}.`))
      const pair = hits.sort((a, b) => keyOf(b).length - keyOf(a).length)[0]
      if (!pair) return place
      words = words.slice(keyOf(pair).split('.').length)
      node = valueOf(pair)
      const key = span(pair.key as Node, text)
      place = words.length === 0 && isScalar(node) && node.range && node.range[1] > node.range[0] ? firstLine(text, span(node, text)) : key
    } else return place
  }
  return place
}

function firstLine(text: string, [from, to]: [number, number]): [number, number] {
  const end = text.slice(from, to).search(/\r?\n/)
  return [from, end < 0 ? to : from + end]
}

function lineOf(text: string, line: number, column: number): [number, number] {
  let start = 0
  for (let i = 1; i < line && text.indexOf('\n', start) >= 0; i++) start = text.indexOf('\n', start) + 1
  const end = start + text.slice(start).search(/\r?\n|$/)
  const from = Math.min(start + column - 1, end)
  return from < end ? [from, end] : [start, end]
}

export interface Standing {
  at: At
  on: 'key' | 'value'
  from: number
  to: number
}

/** The field at a position, with nested names joined by dots. Null between fields. */
export function fieldAt({ text, root }: Tree, position: number): Standing | null {
  const at: Step[] = []
  let node = root
  let found: Standing | null = null
  while (node) {
    if (isMap(node)) {
      const pair = node.items.find((one) => position >= startOf(one) && position <= endOf(one, text))
      if (!pair) return found
      at.push(keyOf(pair))
      const [from, to] = span(pair.key as Node, text)
      if (position <= Math.max(to, colonOf(pair))) return { at: joined(at), on: 'key', from, to }
      node = valueOf(pair)
      found = { at: joined(at), on: 'value', from: to, to: endOf(pair, text) }
    } else if (isSeq(node)) {
      const index = (node.items as Node[]).findIndex((item) => {
        const [from, to] = span(item, text)
        return position >= from && position <= to
      })
      if (index < 0) return found
      at.push(index)
      node = node.items[index] as Node
    } else {
      const [from, to] = span(node, text)
      return position >= from && position <= to ? { at: joined(at), on: 'value', from, to } : found
    }
  }
  return found
}

function joined(at: At): At {
  const names = at.findIndex((step) => NESTING.has(step))
  if (names < 0 || at.length <= names + 2 || at[0] === 'uncertain') return [...at]
  return [...at.slice(0, names + 1), at.slice(names + 1).join('.')]
}
