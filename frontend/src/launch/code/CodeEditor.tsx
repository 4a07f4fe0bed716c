// The YAML editor of a campaign: problems are marked in their lines, completions are offered, and the field at the cursor
// is described below. Loaded as a separate bundle.
import { setDiagnostics } from '@codemirror/lint'
import { EditorView } from '@codemirror/view'
import { useQuery, useQueryClient } from '@tanstack/react-query'
import { clsx } from 'clsx'
import { type RefObject, useEffect, useEffectEvent, useMemo, useRef, useState } from 'react'
import type { Campaign } from '../../api/campaign'
import type { FieldProblem } from '../../api/problems'
import { schemaQuery } from '../../api/queries'
import type { Catalogue } from '../../client'
import { stretch } from '../draft/history'
import { fieldAt, placeOf, tolerant } from '../text/places'
import { plain } from '../text/tree'
import { hintOf, type Known } from './hints'
import { ProblemList } from './ProblemList'
import type { Schema } from '../../api/schema'
import { diagnosticsOf, fromPage, type Hands, locking, opened, placedIn, unified } from './setup'
import { TextButton } from '../../ui/Button'
import styles from './code.module.css'

export interface CodeEditorProps {
  text: string
  readOnly: boolean
  campaign: Campaign
  catalogue: Catalogue
  problems: readonly FieldProblem[]
  /** The problems belong to an earlier text. */
  checking: boolean
  /** A field to navigate to, once per object. */
  jump: { field: string } | null
  onChange: (text: string) => void
  onUndo: () => void
  onRedo: () => void
  /** Goes to a field in the form. */
  onForm: (field: string) => void
}

export default function CodeEditor(props: CodeEditorProps) {
  const { problems, checking, jump, onForm } = props
  const host = useRef<HTMLDivElement>(null)
  const [cursor, setCursor] = useState<number | null>(null)
  const { data, isError } = useQuery(schemaQuery)
  const schema = data as Schema | undefined
  const view = useView(host, props, setCursor)
  const lines = unified(props.text)
  const placed = useMemo(() => placedIn(lines, problems), [lines, problems])
  useEffect(() => {
    if (view.current && !checking) view.current.dispatch(setDiagnostics(view.current.state, diagnosticsOf(placed)))
  }, [view, placed, checking])
  const go = (from: number, to: number) => {
    if (!view.current) return
    const selection = { anchor: from, head: Math.min(to, view.current.state.doc.length) }
    view.current.dispatch({ selection, effects: EditorView.scrollIntoView(from, { y: 'center' }) })
    view.current.focus()
    host.current?.scrollIntoView({ block: 'nearest' })
  }
  const reached = useRef<{ field: string } | null>(null)
  useEffect(() => {
    if (!jump || reached.current === jump || !view.current) return
    reached.current = jump
    go(...placeOf(tolerant(view.current.state.doc.toString()), jump.field))
  })
  return (
    <>
      <div data-editor ref={host} />
      {isError && (
        <p className={clsx(styles.codefoot, 'small')} role="status">
          The schema of campaigns could not be loaded, so completions and descriptions are incomplete. Ctrl Space tries again.
        </p>
      )}
      <Standing {...props} text={lines} cursor={cursor} schema={schema} />
      <ProblemList placed={placed} onGo={go} onForm={onForm} />
    </>
  )
}

/** Creates the editor and keeps it in sync with the page. */
function useView(
  host: RefObject<HTMLDivElement | null>,
  props: CodeEditorProps,
  onCursor: (at: number) => void,
): RefObject<EditorView | null> {
  const view = useRef<EditorView | null>(null)
  const cache = useQueryClient()
  const now = useEffectEvent(() => props)
  useEffect(() => {
    if (!host.current) return
    const schema = (): Schema | undefined => cache.getQueryData(schemaQuery.queryKey)
    const hands: Hands = {
      // The line ends of the file are kept.
      onChange: (text) => now().onChange(now().text.includes('\r\n') ? text.replaceAll('\n', '\r\n') : text),
      onCursor,
      onUndo: () => now().onUndo(),
      onRedo: () => now().onRedo(),
      known: (text): Known => ({ ...now(), schema: schema(), document: plain(tolerant(text)) }),
      loading: (explicit) =>
        schema() || (!explicit && cache.getQueryState(schemaQuery.queryKey)?.status === 'error')
          ? null
          : cache.fetchQuery(schemaQuery).catch(() => null),
    }
    const made = opened(host.current, now().text, now().readOnly, hands)
    view.current = made
    return () => made.destroy()
  }, [host, cache, onCursor])
  const { text, readOnly } = props
  useEffect(() => {
    const shown = view.current?.state.doc.toString() ?? ''
    if (shown === unified(text)) return
    const { from, before, after } = stretch(shown, unified(text))
    view.current?.dispatch({
      changes: { from, to: from + before.length, insert: after },
      selection: { anchor: from + after.length },
      annotations: fromPage.of(true),
      scrollIntoView: true,
    })
  }, [text])
  useEffect(() => view.current?.dispatch({ effects: locking(readOnly) }), [readOnly])
  return view
}

interface StandingProps extends CodeEditorProps {
  cursor: number | null
  schema: Schema | undefined
}

/** The description of the field at the cursor, as in the tooltip. */
function Standing({ text, cursor, campaign, catalogue, schema, readOnly, onForm }: StandingProps) {
  const found = useMemo(() => {
    if (cursor === null) return null
    const tree = tolerant(text)
    const standing = fieldAt(tree, Math.min(cursor, text.length))
    if (!standing) return null
    const hint = hintOf({ campaign, catalogue, schema, document: plain(tree) }, standing.at)
    const says = hint && (hint.detail || hint.text || hint.title.toLowerCase() !== String(standing.at.at(-1)).toLowerCase())
    return { field: standing.at.join('.'), hint: says ? hint : null }
  }, [text, cursor, campaign, catalogue, schema])
  return (
    <div className={clsx(styles.codefoot, 'small')} data-testid="standing">
      {found ? (
        <>
          <span className="mono">{found.field}</span>
          {found.hint && (
            <span className="sec">
              {found.hint.title}
              {found.hint.detail && <span className="mut">, {found.hint.detail}</span>}
              {found.hint.text && <span className="mut">. {found.hint.text}</span>}
            </span>
          )}
          <TextButton onClick={() => onForm(found.field)}>Show in the form</TextButton>
        </>
      ) : (
        <span className="mut">{readOnly ? 'Touch a line to see its description.' : 'Ctrl Space suggests completions, Ctrl F searches, F8 goes to the next problem.'}</span>
      )}
    </div>
  )
}
