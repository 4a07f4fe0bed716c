// Completion: the possible keys or values at the cursor.
import type { Completion, CompletionContext, CompletionResult } from '@codemirror/autocomplete'
import { isMap } from 'yaml'
import { fieldAt, tolerant } from '../text/places'
import { walk } from '../text/tree'
import { type Choice, keysAt, type Known, valuesAt } from './hints'
import { hintElement } from './hover'

const MARK = 'zz__'

/** The completions at a position, keys or values, and the start of the text that they replace. */
export function choicesIn(
  text: string,
  position: number,
  known: Known,
): { from: number; keys: boolean; choices: Choice[] } | null {
  const before = text.slice(text.lastIndexOf('\n', position - 1) + 1, position)
  if (/(^|\s)#/.test(before)) return null
  const word = /[\w.]*$/.exec(before)?.[0] ?? ''
  const from = position - word.length
  const rest = /^[\w.]*/.exec(text.slice(position))?.[0].length ?? 0
  const inserted = (mark: string) => text.slice(0, from) + mark + text.slice(position + rest)
  const ahead = before.slice(0, before.length - word.length)
  const hasColon = /^\s*:/.test(text.slice(position + rest))
  if (/^\s*(- *)*$|[{,] *$/.test(ahead)) {
    // A key is possible here, if inside a mapping.
    const tree = tolerant(inserted(hasColon ? MARK : `${MARK}: 0`))
    const standing = fieldAt(tree, from + 1)
    if (standing?.on === 'key') {
      const above = standing.at.slice(0, -1)
      const name = String(standing.at.at(-1)).slice(0, -MARK.length)
      const inMap = tree.root !== null && (above.length === 0 || isMap(walk({ root: tree.root }, above).node) || name !== '')
      if (inMap && !(ahead.trimEnd().endsWith(',') && typeof above.at(-1) === 'number' && above.at(-2) === 'between'))
        return { from, keys: !hasColon, choices: keysAt(known, above) }
    }
  }
  if (!/[:[,-]\s+$|\[$/.test(ahead)) return null
  const standing = fieldAt(tolerant(inserted(MARK)), from + 1)
  return standing?.on === 'value' ? { from, keys: false, choices: valuesAt(known, standing.at) } : null
}

/** The schema is loaded with the editor: what only it can tell is waited for. */
export const completed =
  (known: (text: string) => Known, loading: (explicit: boolean) => Promise<unknown> | null) =>
  (context: CompletionContext): CompletionResult | null | Promise<CompletionResult | null> => {
    const text = context.state.doc.toString()
    const found = choicesIn(text, context.pos, known(text))
    const coming = context.explicit || found?.choices.length === 0 ? loading(context.explicit) : null
    if (!coming || found?.choices.length) return resultOf(found, context)
    return coming.then(() => resultOf(choicesIn(text, context.pos, known(text)), context))
  }

function resultOf(found: ReturnType<typeof choicesIn>, context: CompletionContext): CompletionResult | null {
  if (!found || found.choices.length === 0 || (found.from === context.pos && !context.explicit)) return null
  const options = found.choices.map((choice, i): Completion => {
    const { name, title, detail = '', text: words = '' } = choice
    return {
      label: name,
      detail: title,
      // The catalogue's order is meaningful: it breaks ties.
      boost: -Math.min(90, i),
      apply: found.keys ? `${name}: ` : name,
      info: detail || words ? () => hintElement({ title: title ?? name, detail, text: words }) : undefined,
    }
  })
  return { from: found.from, options, validFor: /^[\w.]*$/ }
}
