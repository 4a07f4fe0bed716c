// Pieces of text put in the place of others, and what that means between braces and brackets. Start reading at `spliced`.
import type { Node, YAMLMap, YAMLSeq } from 'yaml'
import { type Entry, endOf, type Parsed, span, startOf, tokenOf } from './tree'

export interface Splice {
  from: number
  to: number
  put: string
}

/** The text with all of them made; none may reach into another. */
export function spliced(text: string, splices: readonly Splice[]): string {
  const sorted = [...splices].sort((a, b) => a.from - b.from || a.to - b.to)
  let [done, at] = ['', 0]
  for (const { from, to, put } of sorted) {
    done += text.slice(at, from) + put
    at = to
  }
  return done + text.slice(at)
}

export const isFlow = (node: YAMLMap | YAMLSeq): boolean => Boolean(node.flow)

/** Whether two places stand on one line. */
export const onLine = (text: string, from: number, to: number): boolean => !text.slice(Math.min(from, to), Math.max(from, to)).includes('\n')

function spanOf(owner: YAMLMap | YAMLSeq, index: number, text: string): [number, number] {
  const item = owner.items[index] as Entry | Node
  return 'key' in item ? [startOf(item), endOf(item, text)] : span(item, text)
}

/** Another entry between braces or brackets; on a line of its own where the others are. */
export function intoFlow({ text }: Parsed, owner: YAMLMap | YAMLSeq, index: number, words: string): Splice[] {
  if (owner.items.length === 0) {
    const from = (owner.range?.[0] ?? 0) + 1
    return [{ from, to: from, put: words }]
  }
  const [start, end] = spanOf(owner, Math.max(0, index - 1), text)
  const gap = /\r?\n *$/.exec(text.slice(0, start))?.[0] ?? ' '
  return index === 0
    ? [{ from: start, to: start, put: `${words},${gap}` }]
    : [{ from: end, to: end, put: `,${gap}${words}` }]
}

/** Takes an entry out from between braces or brackets, with one comma and the space that held it. */
export function cutFlow({ text }: Parsed, owner: YAMLMap | YAMLSeq, index: number): Splice[] {
  let [from, to] = spanOf(owner, index, text)
  const comma = tokenOf(owner, index > 0 ? index : 1, 'comma')
  if (comma < 0) {
    const trailing = /^\s*,/.exec(text.slice(to))
    return [{ from, to: to + (trailing?.[0].length ?? 0), put: '' }]
  }
  if (index > 0 && /^\s*$/.test(text.slice(comma + 1, from))) return [{ from: comma, to, put: '' }]
  if (index === 0 && /^\s*$/.test(text.slice(to, comma))) {
    to = comma + 1
    const gap = /^(?: |\r?\n *)*/.exec(text.slice(to))?.[0] ?? ''
    // Without a space before it, a comment would be none.
    return [{ from, to: to + gap.length, put: text[to + gap.length] === '#' ? ' ' : '' }]
  }
  // A comment stands between: it stays, and so does the end of its line.
  const line = text.lastIndexOf('\n', from - 1) + 1
  if (text.slice(line, from).trim() === '' && /^[ \t]*(\r?\n|$)/.test(text.slice(to))) {
    from = line
    to += /^[ \t]*(\r?\n|$)/.exec(text.slice(to))?.[0].length ?? 0
  }
  return [{ from: comma, to: comma + 1, put: '' }, { from, to, put: '' }].sort((a, b) => a.from - b.from)
}
