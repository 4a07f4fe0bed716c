// Assembles the editor: YAML, folding, search, completion, diagnostics. Undo is provided by the page, because it also
// covers edits of the form.
import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from '@codemirror/autocomplete'
import { defaultKeymap } from '@codemirror/commands'
import { yaml } from '@codemirror/lang-yaml'
import { bracketMatching, foldGutter, foldKeymap, indentOnInput, indentUnit } from '@codemirror/language'
import { type Diagnostic, lintGutter, nextDiagnostic, previousDiagnostic } from '@codemirror/lint'
import { search, searchKeymap } from '@codemirror/search'
import { Annotation, Compartment, EditorState, type Extension } from '@codemirror/state'
import {
  drawSelection,
  dropCursor,
  EditorView,
  highlightActiveLine,
  highlightActiveLineGutter,
  keymap,
  lineNumbers,
} from '@codemirror/view'
import type { FieldProblem } from '../../api/problems'
import { placeOf, tolerant } from '../text/places'
import { completed } from './complete'
import type { Known } from './hints'
import { hovered } from './hover'
import { look } from './look'
import { marks } from './marks'

export interface Hands {
  onChange: (text: string) => void
  onCursor: (position: number) => void
  onUndo: () => void
  onRedo: () => void
  known: (text: string) => Known
  /** Until the schema is there, or has failed; null if nothing is to be waited for. After a failure it is requested again
   * if completions are asked for, not at every key. */
  loading: (explicit: boolean) => Promise<unknown> | null
}

/** Marks a change made by the page. */
export const fromPage = Annotation.define<boolean>()

const locked = new Compartment()
const lock = (readOnly: boolean): Extension => [
  EditorState.readOnly.of(readOnly),
  EditorView.editable.of(!readOnly),
  EditorView.contentAttributes.of({
    'aria-label': 'Campaign as YAML',
    'aria-readonly': String(readOnly),
    // Read-only text is still accessible by keyboard.
    tabindex: '0',
  }),
]
export const locking = (readOnly: boolean) => locked.reconfigure(lock(readOnly))

const WORDS = {
  Find: 'Find',
  next: 'Next',
  previous: 'Previous',
  all: 'All',
  'match case': 'Match case',
  regexp: 'Regular expression',
  'by word': 'Whole words',
  replace: 'Replace',
  'replace all': 'Replace all',
  close: 'Close the search',
}

/** Lines by the editor's count. */
export const unified = (text: string): string => text.replace(/\r\n?/g, '\n')

/** An editor in its own shadow tree with constructed style sheets. */
export function opened(host: HTMLElement, text: string, readOnly: boolean, hands: Hands): EditorView {
  const root = host.shadowRoot ?? host.attachShadow({ mode: 'open' })
  const page = (act: () => void) => () => {
    act()
    return true
  }
  const undoing = [
    { key: 'Mod-z', run: page(hands.onUndo), preventDefault: true },
    { key: 'Mod-y', mac: 'Mod-Shift-z', run: page(hands.onRedo), preventDefault: true },
    { linux: 'Ctrl-Shift-z', run: page(hands.onRedo), preventDefault: true },
  ]
  const extensions: Extension[] = [
    lineNumbers(),
    highlightActiveLineGutter(),
    lintGutter(),
    foldGutter(),
    drawSelection(),
    dropCursor(),
    EditorState.allowMultipleSelections.of(true),
    indentOnInput(),
    indentUnit.of('  '),
    bracketMatching(),
    closeBrackets(),
    autocompletion({ override: [completed(hands.known, hands.loading)], icons: false, maxRenderedOptions: 200 }),
    highlightActiveLine(),
    search({ top: true }),
    EditorState.phrases.of(WORDS),
    EditorView.lineWrapping,
    yaml(),
    marks,
    hovered(hands.known),
    look,
    locked.of(lock(readOnly)),
    keymap.of([...undoing, ...closeBracketsKeymap, ...completionKeymap, ...searchKeymap, ...foldKeymap]),
    keymap.of([{ key: 'F8', run: nextDiagnostic }, { key: 'Shift-F8', run: previousDiagnostic }, ...defaultKeymap]),
    EditorView.domEventHandlers({
      beforeinput: (event) => {
        if (event.inputType !== 'historyUndo' && event.inputType !== 'historyRedo') return false
        event.preventDefault()
        if (event.inputType === 'historyUndo') hands.onUndo()
        else hands.onRedo()
        return true
      },
    }),
    EditorView.updateListener.of((update) => {
      const own = !update.transactions.some((one) => one.annotation(fromPage))
      if (update.docChanged && own) hands.onChange(update.state.doc.toString())
      if (update.docChanged || update.selectionSet) hands.onCursor(update.state.selection.main.head)
    }),
  ]
  return new EditorView({ state: EditorState.create({ doc: unified(text), extensions }), parent: root, root })
}

export interface Placed {
  problem: FieldProblem
  from: number
  to: number
  line: number
}

/** Positions of the problems in a text. */
export function placedIn(text: string, problems: readonly FieldProblem[]): Placed[] {
  const tree = tolerant(text)
  return problems.map((problem) => {
    const [from, to] = placeOf(tree, problem.field)
    return { problem, from, to, line: text.slice(0, from).split('\n').length }
  })
}

export const diagnosticsOf = (placed: readonly Placed[]): Diagnostic[] =>
  placed.map(({ problem, from, to }) => ({ from, to, severity: 'error', message: sentence(problem) }))

export function sentence({ message, given }: FieldProblem): string {
  const words = message.charAt(0).toUpperCase() + message.slice(1)
  return given ? `${words} (given ${given})` : words
}
