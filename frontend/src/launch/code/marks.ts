// Highlighting that the grammar does not provide: text, numbers and keywords among values; and the indentation of wrapped
// lines.
import { syntaxTree } from '@codemirror/language'
import { type Range, RangeSetBuilder } from '@codemirror/state'
import { Decoration, type DecorationSet, type EditorView, ViewPlugin, type ViewUpdate } from '@codemirror/view'
import { DEEPEST } from './look'

const NUMBER = /^[-+]?(\.\d+|\d+(\.\d*)?)([eE][-+]?\d+)?$|^[-+]?\.(inf|Inf|INF)$|^\.(nan|NaN|NAN)$/
const WORD = /^(true|True|TRUE|false|False|FALSE|null|Null|NULL|~)$/

const text = Decoration.mark({ class: 'cm-text' })
const word = Decoration.mark({ class: 'cm-word' })
const indented = new Map(
  Array.from({ length: DEEPEST / 2 + 1 }, (_, i) => [2 * i, Decoration.line({ class: `cm-in${2 * i}` })]),
)

function build(view: EditorView): DecorationSet {
  const found: Range<Decoration>[] = []
  for (const { from, to } of view.visibleRanges) {
    for (let at = from; at <= to; ) {
      const line = view.state.doc.lineAt(at)
      const spaces = Math.min(DEEPEST, (/^ */.exec(line.text)?.[0].length ?? 0) & ~1)
      found.push((indented.get(spaces) as Decoration).range(line.from))
      at = line.to + 1
    }
    syntaxTree(view.state).iterate({
      from,
      to,
      enter: (node) => {
        if (node.name === 'Key') return false
        if (node.name !== 'Literal' && node.name !== 'BlockLiteralContent') return undefined
        const literal = node.name === 'Literal' ? view.state.doc.sliceString(node.from, node.to) : ''
        if (!NUMBER.test(literal) && node.to > node.from) found.push((WORD.test(literal) ? word : text).range(node.from, node.to))
        return undefined
      },
    })
  }
  const set = new RangeSetBuilder<Decoration>()
  found.sort((a, b) => a.from - b.from || a.value.startSide - b.value.startSide)
  for (const range of found) set.add(range.from, range.to, range.value)
  return set.finish()
}

export const marks = ViewPlugin.fromClass(
  class {
    decorations: DecorationSet
    constructor(view: EditorView) {
      this.decorations = build(view)
    }
    update(update: ViewUpdate) {
      const parsed = syntaxTree(update.startState) !== syntaxTree(update.state)
      if (update.docChanged || update.viewportChanged || parsed) this.decorations = build(update.view)
    }
  },
  { decorations: (plugin) => plugin.decorations },
)
