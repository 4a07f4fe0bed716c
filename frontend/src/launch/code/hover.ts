// The tooltip with the description of a field.
import { type Extension } from '@codemirror/state'
import { hoverTooltip } from '@codemirror/view'
import { fieldAt, tolerant } from '../text/places'
import { type Hint, hintOf, type Known } from './hints'

export function hintElement({ title, detail, text }: Hint): HTMLElement {
  const box = document.createElement('div')
  box.className = 'cm-hint'
  for (const [tag, words] of [['b', title], ['small', detail], ['p', text]] as const) {
    if (!words) continue
    const line = document.createElement(tag)
    line.textContent = words
    box.append(line)
  }
  return box
}

export const hovered = (known: (text: string) => Known): Extension =>
  hoverTooltip((view, position) => {
    const text = view.state.doc.toString()
    const standing = fieldAt(tolerant(text), position)
    const hint = standing && hintOf(known(text), standing.at)
    // No tooltip inside large mappings.
    if (!standing || !hint || (standing.on === 'value' && text.slice(standing.from, standing.to).includes('\n'))) return null
    return { pos: standing.from, end: standing.to, above: true, create: () => ({ dom: hintElement(hint) }) }
  })
