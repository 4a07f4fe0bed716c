// The tokens that an edit moves or inserts: values, and the spaces and comments around them.
import { CST, Parser } from 'yaml'

export type Item = CST.CollectionItem
export type Leaf = CST.SourceToken
export type Collection = CST.BlockMap | CST.BlockSequence | CST.FlowCollection

const leaf = (type: Leaf['type'], source: string): Leaf => ({ type, source, offset: -1, indent: -1 })
export const space = (width = 1): Leaf[] => (width > 0 ? [leaf('space', ' '.repeat(width))] : [])
export const newline = (source: string): Leaf => leaf('newline', source)
export const comma: Leaf = leaf('comma', ',')

export const isTrivia = ({ type }: CST.Token): boolean => type === 'space' || type === 'newline' || type === 'comment'
export const hasComment = (leaves: readonly Leaf[]): boolean => leaves.some(({ type }) => type === 'comment')
export const isNewline = ({ type }: Leaf): boolean => type === 'newline'

/** The first entry of a mapping or a list in this notation. */
export function entryOf(text: string): Item {
  for (const token of new Parser().parse(text))
    if (token.type === 'document' && CST.isCollection(token.value)) {
      const [item] = token.value.items
      if (item) return item
    }
  throw new Error(`no entry: ${text}`)
}

/** The token of a value in this notation. */
export function valueOf(text: string): CST.Token {
  for (const token of new Parser().parse(text)) if (token.type === 'document' && token.value) return token.value
  throw new Error(`no value: ${text}`)
}

/** Index of the first trailing token without content. */
function trailing(leaves: readonly Leaf[]): number {
  return leaves.findLastIndex((one) => !isTrivia(one)) + 1
}

/** Removes and returns spaces, line ends and comments after a value. */
export function takeTail(token: CST.Token): Leaf[] {
  if (token.type === 'flow-collection') return token.end.splice(1)
  if (token.type === 'block-scalar') {
    const end = /\r?\n$/.exec(token.source)?.[0] ?? ''
    token.source = token.source.slice(0, token.source.length - end.length)
    return end ? [newline(end)] : []
  }
  if (CST.isCollection(token)) return takeLast(token.items)
  return 'end' in token ? (token.end?.splice(0) ?? []) : []
}

/** As `takeTail`, of the last entry; comments behind it are an entry without anything else. */
export function takeLast(items: Item[]): Leaf[] {
  const last = items.at(-1)
  if (!last) return []
  if (last.value) return takeTail(last.value)
  if (last.sep) return last.sep.splice(trailing(last.sep))
  const tail = last.start.splice(trailing(last.start))
  if (last.start.length > 0) return tail
  items.pop()
  return [...takeLast(items), ...tail]
}

/** Appends them to a value. */
export function putTail(token: CST.Token, tail: readonly Leaf[]): void {
  if (token.type === 'block-scalar') token.source += tail.map(({ source }) => source).join('')
  else if (token.type === 'flow-collection') token.end.push(...tail)
  else if (CST.isCollection(token)) token.items.push({ start: [...tail] })
  else if ('end' in token && token.end) token.end.push(...tail)
  else Object.assign(token, { end: [...tail] })
}

/** Leaves to the end of their first line, and those of further lines. */
export function byLine(leaves: readonly Leaf[]): [Leaf[], Leaf[]] {
  const end = leaves.findIndex(isNewline) + 1
  return end === 0 ? [[...leaves], []] : [leaves.slice(0, end), leaves.slice(end)]
}

/** Leaves to the end of their last full line: without what indents the line after it. */
export const fullLines = (leaves: readonly Leaf[]): Leaf[] => leaves.slice(0, leaves.findLastIndex(isNewline) + 1)
