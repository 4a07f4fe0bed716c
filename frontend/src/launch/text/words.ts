// Formats values as readable YAML: small mappings and lists on one line, parts on their own lines.
import { Document, isCollection, isMap, type Pair, Scalar, visit, type YAMLMap, type YAMLSeq } from 'yaml'
import type { Json } from '../../api/campaign'

/** Maximum line length where lines can be broken. */
const WIDTH = 100

type Collection = YAMLMap | YAMLSeq
type Mapping = { [key: string]: Json }
export const isMapping = (value: unknown): value is Mapping =>
  typeof value === 'object' && value !== null && !Array.isArray(value)

// Characters that YAML 1.1 treats as line ends, or refuses.
const HIDDEN = /[\u007f-\u00a0\u2028\u2029\ufeff]/g
const escaped = (sign: string): string => `\\u${sign.charCodeAt(0).toString(16).padStart(4, '0')}`

export interface Style {
  json?: boolean
  /** All in one line. */
  flow?: boolean
  /** Column of the first line [characters]. */
  column?: number
  /** Spaces of one level. */
  indent?: number
}

/** A mapping, list or scalar as text with a final line end. `on`, `yes` and the like are quoted for other parsers. */
export function written(value: Json | Scalar, { json = false, flow = false, column = 0, indent = 2 }: Style = {}): string {
  const document = new Document(value, { compat: 'yaml-1.1', aliasDuplicateObjects: false })
  visit(document, {
    Collection: (_, node, path) => {
      if (flow || json) node.flow = true
      else if (path.length > 1) node.flow = isShort(node, column + before(path as Node[], indent))
    },
    Scalar: (_, node) => {
      if (typeof node.value === 'string' && node.type === undefined) node.type = typeOf(node.value, flow || json)
    },
  })
  const quotes = json ? ({ defaultStringType: 'QUOTE_DOUBLE', defaultKeyType: 'QUOTE_DOUBLE' } as const) : {}
  const text = document.toString({ lineWidth: 0, flowCollectionPadding: false, indent, ...ONE_LINE, ...quotes })
  return text.replace(/^(?=.)/gm, ' '.repeat(column)).replace(HIDDEN, escaped)
}

/** Quoted text stays on one line. */
const ONE_LINE = { doubleQuotedMinMultiLineLength: Number.MAX_SAFE_INTEGER }

/** Undefined leaves the choice to the library. */
function typeOf(text: string, flow: boolean): Scalar.Type | undefined {
  if (text.search(HIDDEN) >= 0) return Scalar.QUOTE_DOUBLE
  if (!text.includes('\n')) return undefined
  return flow || !/^\S/.test(text) || /[^\n\P{Cc}]/u.test(text) ? Scalar.QUOTE_DOUBLE : Scalar.BLOCK_LITERAL
}

/** A scalar in one line. */
export const scalar = (value: Json): string => written(value, { flow: true }).trimEnd()

type Node = Document | Collection | Pair

/** Number of characters before a collection in its line. */
function before(path: readonly Node[], indent: number): number {
  const above = path.filter((node) => isCollection(node)).length - 1
  const last = path.at(-1)
  return above * indent + (last && 'key' in last ? String(last.key).length + 2 : 2)
}

const isPart = (node: unknown): boolean => isMap(node) && node.has('component')
const isFull = (node: unknown): node is Collection => isCollection(node) && node.items.length > 0
const valuesOf = (node: Collection): unknown[] => (isMap(node) ? node.items.map((pair) => pair.value) : node.items)

/** Whether a collection fits on one line after the given number of characters. */
function isShort(node: Collection, before: number): boolean {
  const inner = valuesOf(node)
  if (inner.length === 0) return true
  if (isPart(node) || inner.some((one) => isPart(one) || (isFull(one) && valuesOf(one).some(isCollection)))) return false
  return before + written(node.toJSON() as Json, { flow: true }).length <= WIDTH
}
