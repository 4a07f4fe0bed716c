// The editor's theme, based on the theme tokens, so that it follows light and dark. The rules are constructed style sheets
// in the editor's shadow tree, which need no exception in the content security policy. Start: `look`.
import { HighlightStyle, syntaxHighlighting } from '@codemirror/language'
import type { Extension } from '@codemirror/state'
import { EditorView } from '@codemirror/view'
import { tags } from '@lezer/highlight'

const colours = HighlightStyle.define([
  { tag: tags.definition(tags.propertyName), color: 'var(--link)' },
  { tag: [tags.string, tags.special(tags.string)], color: 'var(--ok)' },
  { tag: [tags.comment, tags.meta], color: 'var(--ink-3)' },
  { tag: [tags.separator, tags.punctuation, tags.squareBracket, tags.brace], color: 'var(--ink-2)' },
])

/** Maximum indentation of a wrapped line [characters]. */
export const DEEPEST = 16

const indents = Object.fromEntries(
  Array.from({ length: DEEPEST / 2 + 1 }, (_, i) => [
    `.cm-in${2 * i}`,
    { paddingLeft: `calc(4px + ${2 * i + 4}ch)`, textIndent: `-${2 * i + 4}ch` },
  ]),
)

const PANEL = { background: 'var(--surface)', color: 'var(--ink)', border: '1px solid var(--line-2)', borderRadius: 'var(--r2)' }

const rules = EditorView.theme({
  '&': { color: 'var(--ink)', background: 'var(--surface)', maxHeight: '70vh', fontSize: '12px' },
  '&.cm-focused': { outline: '2px solid var(--focus)', outlineOffset: '-2px' },
  '.cm-scroller': { fontFamily: 'var(--mono)', lineHeight: '19px', overflow: 'auto' },
  '.cm-content': { padding: '10px 0', caretColor: 'var(--ink)' },
  '.cm-line': { padding: '0 16px 0 4px' },
  ...indents,
  '.cm-cursor': { borderLeftColor: 'var(--ink)' },
  '.cm-gutters': { background: 'transparent', color: 'var(--ink-3)', border: '0' },
  '.cm-lineNumbers .cm-gutterElement': { padding: '0 4px 0 14px', minWidth: '34px' },
  '.cm-activeLine': { background: 'color-mix(in srgb, var(--sel) 45%, transparent)' },
  '.cm-activeLineGutter': { background: 'transparent', color: 'var(--ink)' },
  '.cm-foldGutter .cm-gutterElement': { width: '14px', textAlign: 'center', cursor: 'pointer' },
  '.cm-foldPlaceholder': { background: 'var(--sunken)', color: 'var(--ink-2)', border: '1px solid var(--line-2)', padding: '0 5px' },
  '.cm-selectionBackground, &.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground': {
    background: 'color-mix(in srgb, var(--focus) 26%, transparent)',
  },
  '.cm-matchingBracket, &.cm-focused .cm-matchingBracket': { background: 'var(--sunken)', outline: '1px solid var(--line-2)' },
  '.cm-text': { color: 'var(--ok)' },
  '.cm-word': { color: 'var(--unk)' },
  '.cm-lintRange-error': {
    backgroundImage: 'none',
    textDecoration: 'underline wavy var(--bad-solid) 1px',
    textUnderlineOffset: '3px',
    textDecorationSkipInk: 'none',
  },
  '.cm-lintPoint-error:after': { borderBottomColor: 'var(--bad-solid)' },
  '.cm-gutter-lint': { width: '14px' },
  '.cm-lint-marker': { width: '9px', height: '9px', margin: '5px 2px', content: 'none' },
  '.cm-lint-marker-error': { background: 'var(--bad-solid)', borderRadius: '50%' },
  '.cm-tooltip': { ...PANEL, boxShadow: 'var(--shadow-2)', font: '400 12px/17px var(--font)', maxWidth: '420px' },
  '.cm-tooltip .cm-hint': { padding: '7px 10px' },
  '.cm-hint b': { fontWeight: '600', display: 'block' },
  '.cm-hint small': { fontSize: '12px', color: 'var(--ink-2)', display: 'block', fontFeatureSettings: '"tnum"' },
  '.cm-hint p': { margin: '3px 0 0', color: 'var(--ink-2)' },
  '.cm-diagnostic': { padding: '7px 10px', borderLeft: '3px solid var(--bad-solid)', whiteSpace: 'normal' },
  '.cm-tooltip-autocomplete > ul': { fontFamily: 'var(--mono)', maxHeight: '22em' },
  '.cm-tooltip-autocomplete > ul > li': { padding: '2px 9px', lineHeight: '18px' },
  '.cm-tooltip-autocomplete > ul > li[aria-selected]': { background: 'var(--sel)', color: 'var(--ink)' },
  '.cm-completionDetail': { fontStyle: 'normal', color: 'var(--ink-3)', fontFamily: 'var(--font)', marginLeft: '1em' },
  '.cm-completionMatchedText': { textDecoration: 'none', fontWeight: '700' },
  '.cm-tooltip.cm-completionInfo': { padding: '7px 10px', maxWidth: '320px' },
  '.cm-panels': { background: 'var(--sunken)', color: 'var(--ink)', borderColor: 'var(--line)' },
  '.cm-panel.cm-search': { padding: '6px 10px', font: '400 12px/20px var(--font)' },
  '.cm-panel.cm-search label': { fontSize: '12px', color: 'var(--ink-2)' },
  '.cm-textfield': { ...PANEL, border: '1px solid var(--ctl)', font: '400 12px/20px var(--mono)', padding: '2px 8px' },
  '.cm-button': { ...PANEL, backgroundImage: 'none', font: '500 12px/20px var(--font)', padding: '2px 9px', cursor: 'pointer' },
  '.cm-textfield:focus-visible, .cm-button:focus-visible, .cm-search button:focus-visible, .cm-search input:focus-visible': {
    outline: '2px solid var(--focus)',
    outlineOffset: '1px',
  },
  '.cm-panel.cm-search [name=close]': { color: 'var(--ink)', fontSize: '18px', right: '8px', top: '6px' },
  '.cm-searchMatch': { background: 'var(--unk-bg)', outline: '1px solid var(--unk-line)' },
  '.cm-searchMatch-selected': { background: 'var(--unk-line)' },
  '.cm-dropCursor': { borderLeftColor: 'var(--focus)' },
})

export const look: Extension = [rules, syntaxHighlighting(colours)]
