// A campaign's text changed in the places that an edit means, and nowhere else: comments, order and spelling of everything
// else stay as they were written. Start reading at `amended`.
import { isMap, isSeq, type Node, parseDocument, stringify, type YAMLMap, type YAMLSeq } from 'yaml'
import type { Json } from '../../api/campaign'
import { applied, type Change, equal } from './changes'
import { cutFlow, intoFlow, isFlow, onLine, type Splice, spliced } from './splice'
import {
  type At,
  colonOf,
  dashOf,
  endOf,
  type Entry,
  type Found,
  isBlock,
  keyOf,
  parsed,
  type Parsed,
  plain,
  span,
  startOf,
  valueOf,
  walk,
} from './tree'
import { fits, inline, isLiteral, key, lines, literal, pairLines, scalar } from './words'

/** The text after some changes. Each is read back; one that cannot be made in its place has the text written anew. */
export function amended(text: string, changes: readonly Change[]): string {
  return changes.reduce((before, change) => {
    const tree = treeOf(before)
    if (!tree) return before
    const wanted = applied(plain(tree), change)
    const splices = placed(tree, change)
    const after = splices && spliced(before, splices)
    const again = after === null ? null : treeOf(after)
    return after !== null && again && equal(plain(again), wanted) ? after : rewritten(before, change, wanted)
  }, text)
}

let last: { text: string; tree: Parsed | null } | null = null

/** As `parsed`; the newest text is read once, because the next edit begins with it. */
function treeOf(text: string): Parsed | null {
  if (last?.text !== text) last = { text, tree: parsed(text) }
  return last.tree
}

/** The library's own way: keeps the comments, and sets everything else in its own manner. */
function rewritten(text: string, change: Change, wanted: Json): string {
  const document = parseDocument(text)
  if (change.kind === 'set') document.setIn(change.at, document.createNode(change.value))
  if (change.kind === 'remove') document.deleteIn(change.at)
  const after = document.toString({ lineWidth: 0 })
  const again = parsed(after)
  return again && equal(plain(again), wanted) ? after : stringify(wanted, { lineWidth: 0 })
}

/** Null: it has no place that could be changed by itself. */
function placed(tree: Parsed, change: Change): Splice[] | null {
  const found = walk(tree, change.at)
  const there = found.steps === change.at.length
  if (change.kind === 'rename') return there && found.pair ? renamed(tree, found.pair, change.to) : []
  if (change.kind === 'remove') return there ? removed(tree, found) : []
  if (change.kind === 'insert') return inserted(tree, change)
  if (there) return replaced(tree, found, change.value)
  return added(tree, found, change.at, change.value, change.before)
}

/** What is to stand at the last place that is there, so that the value stands where it belongs. */
const nested = (steps: At, value: Json): Json =>
  steps.reduceRight<Json>((inner, step) => (typeof step === 'number' ? [inner] : { [step]: inner }), value)

function added(tree: Parsed, found: Found, at: At, value: Json, before: readonly string[]): Splice[] | null {
  const left = at.slice(found.steps)
  if (isMap(found.node)) {
    const name = found.rest ?? String(left[0])
    const inside = String(left[0]).length - name.length
    const siblings = left.length > 1 ? [] : before.map((other) => other.slice(inside))
    return pairInto(tree, found.node, name, nested(left.slice(1), value), siblings)
  }
  return replaced(tree, found, nested(left, value))
}

function inserted(tree: Parsed, { at, value }: { at: At; value: Json }): Splice[] | null {
  const list = walk(tree, at.slice(0, -1))
  const index = Number(at.at(-1))
  if (list.steps < at.length - 1) return added(tree, list, at.slice(0, -1), [value], [])
  if (!isSeq(list.node)) return replaced(tree, list, [value])
  if (isFlow(list.node)) {
    if (list.node.items.length === 0) return replaced(tree, list, [value])
    return intoFlow(tree, list.node, index, inline(value, tree.json))
  }
  return itemInto(tree, list.node, index, value)
}

function renamed(tree: Parsed, pair: Entry, to: string): Splice[] {
  const [from, end] = span(pair.key as Node, tree.text)
  return [{ from, to: end, put: key(to, tree.json) }]
}

/** Column of a place [characters]. */
const column = (text: string, at: number): number => at - (text.lastIndexOf('\n', at - 1) + 1)

function lineEnd(text: string, at: number): number {
  const next = text.indexOf('\n', at)
  const end = next < 0 ? text.length : next
  return text[end - 1] === '\r' ? end - 1 : end
}

/** Another value in the place of one that is there. */
function replaced(tree: Parsed, found: Found, value: Json): Splice[] | null {
  const { text, json } = tree
  const { node, pair, owner } = found
  const [from, to] = node ? span(node, text) : [0, 0]
  const inFlow = json || (owner !== null && isFlow(owner))
  const pad = owner && !inFlow && pair ? column(text, startOf(pair)) : 0
  const isLong = !inFlow && pair !== null && !(typeof value === 'string' ? !isLiteral(value) : fits(value, column(text, endOfHead(pair)) + 2))
  if (typeof value === 'string' && isLong) return literally(tree, pair, node, value, pad)
  const words = typeof value === 'object' && value !== null ? inline(value, json) : spelled(text.slice(from, to), value, inFlow, json)
  const over = node !== null && to > from
  if (!pair || (over && !isLong && onLine(text, endOfHead(pair), from))) {
    if (isLong) return null
    return isBlock(node) ? literally(tree, pair, node, value, pad) : [{ from, to, put: words }]
  }
  const colon = colonOf(pair) + 1
  const gone: Splice[] = !over
    ? []
    : onLine(text, colon, from)
      ? [{ from: colon, to, put: '' }]
      : [{ from: text.lastIndexOf('\n', from) + 1, to: Math.min(text.length, lineEnd(text, to) + tree.newline.length), put: '' }]
  if (!isLong) return [{ from: colon, to: colon, put: ` ${words}` }, ...gone]
  const after = lineEnd(text, Math.max(colon, onLine(text, colon, from) ? to : colon))
  return [...gone, { from: after, to: after, put: tree.newline + lines(value, pad + 2).join(tree.newline) }]
}

const endOfHead = (pair: Entry): number => colonOf(pair) + 1

/** A scalar, with a decimal point where the one before had one. */
function spelled(before: string, value: Json, inFlow: boolean, json: boolean): string {
  const pointed = typeof value === 'number' && Number.isInteger(value) && /^-?\d+\.\d*$/.test(before)
  if (pointed && Math.abs(value) < 1e15) return `${value}.0`
  return inFlow ? inline(value, json) : scalar(value, json)
}

/** Text over several lines in the place of other text; lines that stay the same stay as they are. */
function literally(tree: Parsed, pair: Entry | null, node: Node | null, value: Json, pad: number): Splice[] | null {
  if (!pair) return null
  const { text, newline } = tree
  const colon = colonOf(pair) + 1
  const [start, end] = node && node.range && node.range[1] > node.range[0] ? span(node, text) : [colon, colon]
  const comment = isBlock(node) ? (/\s+#.*$/.exec(text.slice(start, lineEnd(text, start)))?.[0] ?? '') : ''
  const old = isBlock(node) ? /\n( +)\S/.exec(text.slice(start, end))?.[1]?.length : undefined
  if (typeof value !== 'string' || !isLiteral(value)) return [{ from: colon, to: end, put: ` ${scalar(value)}${comment}` }]
  const [head = '', ...rest] = literal(value, old ?? pad + 2)
  return [{ from: colon, to: end, put: ` ${head}${comment}${newline}${rest.join(newline)}` }]
}

/** A new pair behind those that stand before it where the campaign is written in full, else behind the last. */
function pairInto(tree: Parsed, map: YAMLMap, name: string, value: Json, before: readonly string[]): Splice[] {
  const { text, newline, json } = tree
  const behind = map.items.findLastIndex((pair) => before.includes(keyOf(pair)))
  if (isFlow(map) || map.items.length === 0) {
    const at = behind >= 0 ? behind + 1 : before.length > 0 && map.items.length > 0 ? 0 : map.items.length
    return intoFlow(tree, map, at, `${key(name, json)}: ${inline(value, json)}`)
  }
  const sibling = map.items[behind >= 0 ? behind : map.items.length - 1] as Entry
  const end = lineEnd(text, endOf(sibling, text))
  const indent = column(text, startOf(map.items[0] as Entry))
  const put = pairLines(name, value, indent)
  const apart = map === tree.root && put.length > 1 ? newline : ''
  return [{ from: end, to: end, put: newline + apart + put.join(newline) }]
}

/** A new item of a list over several lines, behind the one before it. */
function itemInto(tree: Parsed, list: YAMLSeq, index: number, value: Json): Splice[] {
  const { text, newline } = tree
  const put = lines([value], column(text, dashOf(list, 0)))
  if (index === 0) {
    const from = text.lastIndexOf('\n', dashOf(list, 0)) + 1
    return [{ from, to: from, put: put.join(newline) + newline }]
  }
  const end = lineEnd(text, Math.max(span(list.items[index - 1] as Node, text)[1], dashOf(list, index - 1) + 1))
  return [{ from: end, to: end, put: newline + put.join(newline) }]
}

/** Takes a pair or an item out, with its own lines; comments on lines of their own stay. */
function removed(tree: Parsed, found: Found): Splice[] | null {
  const { owner, index } = found
  if (!owner) return null
  if (isFlow(owner)) return cutFlow(tree, owner, index)
  if (owner.items.length === 1) return emptied(tree, owner)
  const { text } = tree
  const [from, to] = isMap(owner)
    ? [startOf(owner.items[index] as Entry), endOf(owner.items[index] as Entry, text)]
    : [dashOf(owner, index), Math.max(span(owner.items[index] as Node, text)[1], dashOf(owner, index) + 1)]
  const begin = text.lastIndexOf('\n', from - 1) + 1
  if (text.slice(begin, from).trim() !== '') {
    // The first pair of an item stands behind its dash: what follows moves up to it.
    const next = isMap(owner) && index === 0 ? owner.items[1] : undefined
    if (!next) return null
    return [{ from, to: startOf(next), put: '' }]
  }
  return [lineCut(tree, begin, to)]
}

function lineCut({ text, newline }: Parsed, begin: number, to: number): Splice {
  const end = lineEnd(text, to)
  if (end < text.length) return { from: begin, to: end + newline.length, put: '' }
  return { from: Math.max(0, begin - newline.length), to: end, put: '' }
}

/** A mapping or a list that loses its last entry: empty, behind its key. */
function emptied(tree: Parsed, owner: YAMLMap | YAMLSeq): Splice[] {
  const { text } = tree
  const [from, to] = span(owner, text)
  const put = isMap(owner) ? '{}' : '[]'
  const pair = holderOf(tree.root, owner)
  const colon = pair ? colonOf(pair) + 1 : -1
  if (!pair || onLine(text, colon, from)) return [{ from, to, put }]
  return [{ from: colon, to: colon, put: ` ${put}` }, lineCut(tree, text.lastIndexOf('\n', from) + 1, to)]
}

function holderOf(node: unknown, wanted: Node): Entry | null {
  if (isMap(node))
    for (const pair of node.items) {
      const hit = valueOf(pair) === wanted ? pair : holderOf(pair.value, wanted)
      if (hit) return hit
    }
  if (isSeq(node)) for (const item of node.items) { const hit = holderOf(item, wanted); if (hit) return hit }
  return null
}
