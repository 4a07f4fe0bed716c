// Changes a campaign's text only at the positions of an edit: comments, order and formatting of everything else are kept,
// because only the affected tokens change.
import { CST, isMap, isScalar, isSeq, type Node, parseDocument, Scalar, stringify, type YAMLMap, type YAMLSeq } from 'yaml'
import type { Json } from '../../api/campaign'
import { applied, type Change, equal } from './changes'
import { insertBlock, insertFlow, removeBlock, removeFlow } from './entries'
import { byLine, type Collection, entryOf, fullLines, isNewline, isTrivia, type Item, type Leaf, newline, putTail, space, takeTail, valueOf as tokenOf } from './tokens'
import { type At, type Entry, type Found, isBlock, keyOf, newlineOf, parsed, type Parsed, plain, textOf, valueOf, walk } from './tree'
import { type Style, written } from './words'

/** The text after some changes. Each is verified by parsing; if a change cannot be made in place, the text is regenerated. */
export function amended(text: string, changes: readonly Change[]): string {
  return changes.reduce((before, change) => {
    const tree = treeOf(before)
    if (!tree) return before
    const wanted = applied(plain(tree), change)
    const after = edited(before, change)
    const again = after === null ? null : treeOf(after)
    return after !== null && again && equal(plain(again), wanted) ? after : rewritten(before, change, wanted)
  }, text)
}

/** The text with a change made in place, ending with a line end. Null if it cannot be made in place. */
function edited(text: string, change: Change): string | null {
  const tree = treeOf(text.endsWith('\n') ? text : text + newlineOf(text))
  last = null // its tokens change
  return tree && placed(tree, change) ? textOf(tree) : null
}

let last: { text: string; tree: Parsed | null } | null = null

/** As `parsed`; caches the newest text, because the next edit starts from it. */
function treeOf(text: string): Parsed | null {
  if (last?.text !== text) last = { text, tree: parsed(text) }
  return last.tree
}

/** The YAML library's own layout, which keeps comments. */
function rewritten(text: string, change: Change, wanted: Json): string {
  const document = parseDocument(text)
  if (change.kind === 'set') document.setIn(change.at, document.createNode(change.value))
  if (change.kind === 'remove') document.deleteIn(change.at)
  const after = document.toString({ lineWidth: 0 })
  const again = parsed(after)
  return again && equal(plain(again), wanted) ? after : stringify(wanted, { lineWidth: 0 })
}

/** Whether a change was made in place. */
function placed(tree: Parsed, change: Change): boolean {
  const found = walk(tree, change.at)
  const there = found.steps === change.at.length
  if (change.kind === 'rename') return !there || !found.pair || renamed(tree, found.pair, change.to)
  if (change.kind === 'remove') return !there || removed(tree, found)
  if (change.kind === 'insert') return inserted(tree, change)
  if (there) return replaced(tree, found, change.value)
  return added(tree, found, change.at, change.value, change.before)
}

/** The value for the last existing parent, so that the new value is at its location. */
const nested = (steps: At, value: Json): Json =>
  steps.reduceRight<Json>((inner, step) => (typeof step === 'number' ? [inner] : { [step]: inner }), value)

function added(tree: Parsed, found: Found, at: At, value: Json, before: readonly string[]): boolean {
  const left = at.slice(found.steps)
  if (isMap(found.node)) {
    const name = found.rest ?? String(left[0])
    const inside = String(left[0]).length - name.length
    const siblings = left.length > 1 ? [] : before.map((other) => other.slice(inside))
    return pairInto(tree, found.node, name, nested(left.slice(1), value), siblings)
  }
  return replaced(tree, found, nested(left, value))
}

function inserted(tree: Parsed, { at, value }: { at: At; value: Json }): boolean {
  const list = walk(tree, at.slice(0, -1))
  const index = Number(at.at(-1))
  if (list.steps < at.length - 1) return added(tree, list, at.slice(0, -1), [value], [])
  if (!isSeq(list.node) || list.node.items.length === 0) return replaced(tree, list, [value])
  const owner = tokensOf(list.node)
  if (isFlow(owner)) insertFlow(owner, index, { start: [], value: tokenOf(styled(tree, value, { flow: true })) })
  else insertBlock(owner, index, entryOf(styled(tree, [value], { column: owner.indent })))
  return true
}

const tokensOf = (node: YAMLMap | YAMLSeq): Collection => node.srcToken as Collection
const isFlow = (token: Collection): token is CST.FlowCollection => token.type === 'flow-collection'

/** A value in the notation of the surrounding text. A single-line value has no line end. */
function styled(tree: Parsed, value: Json | Scalar, style: Style): string {
  const text = written(value, { json: tree.json, ...style })
  return style.flow ? text.trimEnd() : text.replaceAll('\n', tree.newline)
}

function renamed(tree: Parsed, pair: Entry, to: string): boolean {
  const { key } = pair.srcToken as Item
  if (!key) return false
  const token = key as CST.FlowScalar
  Object.assign(token, { ...(tokenOf(styled(tree, to, { flow: true })) as CST.FlowScalar), end: token.end })
  return true
}

function replaced(tree: Parsed, found: Found, value: Json): boolean {
  const { node, pair, owner, index } = found
  if (!owner) return false
  if (pair) return pairReplaced(tree, tokensOf(owner), pair, value)
  const item = tokensOf(owner).items[index]
  if (!item?.value || (!isFlow(tokensOf(owner)) && isBlock(node))) return false
  inPlace(item, tokenOf(oneLine(tree, node, value)))
  return true
}

/** A single-line value, with quotes and decimal point as in the previous value. */
function oneLine(tree: Parsed, before: Node | null, value: Json): string {
  const scalar = new Scalar(value)
  const old = isScalar(before) ? before : null
  if (typeof value === 'string' && (old?.type === 'QUOTE_SINGLE' || old?.type === 'QUOTE_DOUBLE')) scalar.type = old.type
  if (typeof value === 'number' && Number.isInteger(value) && Math.abs(value) < 1e15 && /^-?\d+\.\d*$/.test(old?.source ?? ''))
    scalar.minFractionDigits = 1
  return styled(tree, typeof value === 'object' ? value : scalar, { flow: true })
}

function inPlace(item: Item, value: CST.Token): void {
  const tail = item.value ? takeTail(item.value) : []
  putTail(value, tail)
  item.value = value
}

function pairReplaced(tree: Parsed, owner: Collection, pair: Entry, value: Json): boolean {
  const item = pair.srcToken as Item
  const old = valueOf(pair)
  const colon = item.sep?.findIndex(({ type }) => type === 'map-value-ind') ?? -1
  if (!item.sep || colon < 0) return false
  const behind = item.sep.slice(colon + 1)
  const entry = isFlow(owner) ? null : longEntry(tree, owner, pair, value)
  if (!entry && item.value && !CST.isCollection(item.value) && !behind.some(isNewline) && !isBlock(old)) {
    inPlace(item, tokenOf(oneLine(tree, old, value)))
    return true
  }
  const around = trivia(item, behind)
  const named = behind.filter((one) => !isTrivia(one)).flatMap((one) => [one, ...space()])
  item.sep = [...item.sep.slice(0, colon + 1), ...space(), ...named]
  item.value = entry?.value ?? tokenOf(oneLine(tree, old, value))
  if (!entry) putTail(item.value, around)
  else long(item, entry, around, named.length > 0)
  return true
}

/** The comments of a pair whose value is removed: after it or its key, and on their own lines around it. */
function trivia(item: Item, behind: readonly Leaf[]): Leaf[] {
  const head = behind.filter(isTrivia)
  const old = item.value
  if (!old) return head
  const mark = old.type === 'block-scalar' ? (old.props as Leaf[]).filter(isTrivia) : []
  const tail = takeTail(old)
  if (mark.length > 0) return [...mark, ...byLine(tail)[1]]
  return head.some(isNewline) ? [...fullLines(head), ...byLine(tail)[1]] : tail
}

/** A pair with a multi-line value, indented as the previous value; null if it is on one line. */
function longEntry(tree: Parsed, owner: Collection, pair: Entry, value: Json): Item | null {
  if (tree.json || (typeof value !== 'object' && typeof value !== 'string')) return null
  const old = (pair.srcToken as Item).value
  const width = old?.type === 'block-scalar' ? (/^ +(?=\S)/m.exec(old.source)?.[0].length ?? 0) - owner.indent : 0
  const text = styled(tree, { [keyOf(pair)]: value }, { column: owner.indent, indent: width > 0 ? width : 2 })
  return text.trimEnd().includes('\n') ? entryOf(text) : null
}

/** Inserts a multi-line value after its key, and moves the trailing tokens of the previous value. */
function long(item: Item, entry: Item, around: readonly Leaf[], named: boolean): void {
  const [line, further] = byLine(around)
  const { value, sep = [] } = entry
  if (!value || !item.sep) return
  if (value.type === 'block-scalar') value.props = [...value.props.filter((one) => !isTrivia(one)), ...line]
  else item.sep = [...item.sep.slice(0, named ? undefined : -1), ...line, ...sep.slice(sep.findLastIndex(isNewline) + 1)]
  if (further.length > 0) putTail(value, further)
}

/** Inserts a new pair in the order of a complete campaign, else at the end. */
function pairInto(tree: Parsed, map: YAMLMap, name: string, value: Json, before: readonly string[]): boolean {
  const behind = map.items.findLastIndex((pair) => before.includes(keyOf(pair)))
  const owner = tokensOf(map)
  if (isFlow(owner)) {
    const at = behind >= 0 ? behind + 1 : before.length > 0 && map.items.length > 0 ? 0 : map.items.length
    const item = entryOf(styled(tree, { [name]: value }, { flow: true }))
    insertFlow(owner, at, item)
    return true
  }
  const text = styled(tree, { [name]: value }, { column: owner.indent })
  const apart = map === tree.root && text.trimEnd().includes('\n') ? [newline(tree.newline)] : []
  insertBlock(owner, behind >= 0 ? behind + 1 : map.items.length, entryOf(text), apart)
  return true
}

function removed(tree: Parsed, { owner, index }: Found): boolean {
  if (!owner) return false
  const tokens = tokensOf(owner)
  if (isFlow(tokens)) removeFlow(tokens, index)
  else if (owner.items.length > 1) removeBlock(tokens, index)
  else return emptied(tree, owner)
  return true
}

/** Replaces a mapping or list that loses its last entry by an empty one after its key. */
function emptied(tree: Parsed, owner: YAMLMap | YAMLSeq): boolean {
  const [holder, pair] = holderOf(tree.root, owner) ?? []
  return holder !== undefined && pair !== undefined && pairReplaced(tree, tokensOf(holder), pair, isMap(owner) ? {} : [])
}

function holderOf(node: unknown, wanted: Node): [YAMLMap, Entry] | null {
  for (const inner of isMap(node) || isSeq(node) ? node.items : []) {
    const pair = isMap(node) ? (inner as Entry) : null
    if (isMap(node) && pair && valueOf(pair) === wanted) return [node, pair]
    const hit = holderOf(pair ? pair.value : inner, wanted)
    if (hit) return hit
  }
  return null
}
