// Inserts and removes entries of mappings and lists, as tokens.
import { comma, type Collection, fullLines, hasComment, isNewline, isTrivia, type Item, byLine, type Leaf, putTail, space, takeLast, takeTail } from './tokens'

/** The separator between a comma and an entry: a space, or a line end with indentation. */
const gapOf = ({ start }: Item): Leaf[] =>
  start.slice(Math.max(0, start.findLastIndex(isNewline))).filter(({ type }) => type === 'space' || type === 'newline')

/** A new entry on its own lines; `item` is not indented. */
export function insertBlock(owner: Collection, index: number, item: Item, apart: readonly Leaf[] = []): void {
  const pad = space(owner.indent)
  const [first] = owner.items
  if (index === 0 && first) first.start.unshift(...pad)
  else item.start.unshift(...apart, ...pad)
  ;(owner.items as Item[]).splice(index, 0, item)
}

/** Removes an entry with its lines; comments on their own lines stay. */
export function removeBlock(owner: Collection, index: number): void {
  const items = owner.items as Item[]
  const [gone] = items.splice(index, 1)
  if (!gone) return
  const above = fullLines(gone.start.filter(isTrivia))
  const tail = gone.key || gone.value ? takeLast([gone]) : []
  const kept = [...above, ...byLine(tail)[1]]
  const next = items[index]
  if (!next) {
    if (kept.length > 0) items.push({ start: kept })
    return
  }
  // The first entry follows its parent's prefix; so must the entry that replaces it.
  const own = index === 0 && kept.length === 0 && next.start[0]?.type === 'space' ? next.start.slice(1) : next.start
  next.start = [...kept, ...own]
}

/** A new entry between braces or brackets; on its own line if the others are. */
export function insertFlow(owner: Collection, index: number, item: Item): void {
  const items = owner.items as Item[]
  const beside = items[Math.max(0, index - 1)]
  const gap = beside ? gapOf(beside) : []
  if (index > 0 && beside) {
    const tail = items[index]?.start.some(({ type }) => type === 'comma') ? [] : takeLast([beside])
    if (item.value) putTail(item.value, tail)
    item.start = [comma, ...(gap.length > 0 ? gap : space())]
  } else if (beside) {
    item.start = beside.start
    beside.start = [comma, ...(gap.length > 0 ? gap : space())]
  }
  items.splice(index, 0, item)
}

/** Removes an entry between braces or brackets, with one comma; comments stay. */
export function removeFlow(owner: Collection, index: number): void {
  const items = owner.items as Item[]
  const [gone] = items.splice(index, 1)
  if (!gone) return
  const tail = gone.value ? takeTail(gone.value) : []
  const own = gone.start.filter(isTrivia)
  const next = items[index]
  if (!next) {
    const left = hasComment(own) ? [...own, ...tail] : tail
    const last = items.at(-1)
    if (last?.value) putTail(last.value, left)
    else if (left.some(isNewline)) items.push({ start: left })
    return
  }
  const behind = next.start.filter(isTrivia)
  const first = index === 0 ? [] : [comma]
  if (hasComment([...own, ...tail])) next.start = [...first, ...own, ...tail, ...behind]
  else if (index > 0) return
  else next.start = hasComment(behind) ? behind : own
}
