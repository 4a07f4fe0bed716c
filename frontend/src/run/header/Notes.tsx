// Notes on a run, in Markdown.
import { clsx } from 'clsx'
import { IconPencil } from '@tabler/icons-react'
import { useEffect, useState } from 'react'
import { useBarredFromOwn } from '../../api/may'
import type { RunDetail } from '../../client'
import { count } from '../../format/numbers'
import { later, Part } from '../../page/later'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { useEdit } from './useEdit'
import { cards, fields, layout } from '../../ui/styles'
import styles from './header.module.css'

// Most runs have no notes: the parser is loaded on first use.
const Parsed = later(() => import('../../ui/Markdown'), 'Markdown')

const MOST = 20_000

/** What was written and not saved, by run: the card is another one once the run starts, and once it ends. */
const unsaved = new Map<string, { draft: string; read: string }>()

interface NotesProps {
  run: RunDetail
  className: string | undefined
}

/** Those of another run are another card: what is typed belongs to the run that it was typed on. */
export const Notes = (props: NotesProps) => <NotesCard key={props.run.id} {...props} />

function NotesCard({ run, className }: NotesProps) {
  const [draft, setDraft] = useState<string | null>(() => unsaved.get(run.id)?.draft ?? null)
  const [read, setRead] = useState(() => unsaved.get(run.id)?.read ?? '')
  const edit = useEdit(run, (after, sent) => {
    setRead(after.notes)
    setDraft((now) => (now === sent.notes ? null : now)) // what was typed meanwhile is not saved yet
  })
  // Saved, by a card of this run that is no more.
  if (draft !== null && draft === run.notes && draft !== read) setDraft(null)
  const writing = draft !== null
  useEffect(() => {
    if (draft === null || draft === read) {
      unsaved.delete(run.id)
      return
    }
    unsaved.set(run.id, { draft, read })
    const ask = (event: BeforeUnloadEvent) => event.preventDefault()
    window.addEventListener('beforeunload', ask)
    return () => window.removeEventListener('beforeunload', ask)
  }, [run.id, draft, read])
  const barred = useBarredFromOwn('engineer', run)
  const begin = () => {
    edit.reset()
    setRead(run.notes)
    setDraft(run.notes)
  }
  return (
    <Card
      title="Notes"
      note={writing ? 'Markdown: **bold**, *italic*, - lists, [links](https://…), tables' : undefined}
      className={className}
      id="notes"
      right={
        !writing &&
        run.removed === null && (
          <Button small icon={IconPencil} onClick={begin} barred={barred}>{run.notes ? 'Edit' : 'Write'}</Button>
        )
      }
    >
      {writing ? (
        <form
          onSubmit={(event) => {
            event.preventDefault()
            if (!edit.isPending && draft !== run.notes) edit.mutate({ notes: draft, notes_before: read })
          }}
        >
          <div className={styles.writing}>
            <textarea
              value={draft}
              maxLength={MOST}
              aria-label="Notes in Markdown"
              autoFocus
              onChange={(event) => setDraft(event.target.value)}
              onKeyDown={(event) => {
                if (event.key === 'Escape' && draft === run.notes) setDraft(null)
                if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) event.currentTarget.form?.requestSubmit()
              }}
            />
            <div className={styles.preview} aria-label="Preview" role="region">
              {draft.trim() ? <Markdown text={draft} /> : <p className="mut">What you write is shown here.</p>}
            </div>
          </div>
          {edit.isError && <p className={fields.ferr}>{edit.error.message}</p>}
          {run.notes !== read && (
            <div className={cards.note} role="status">
              <b>Written since:</b>
              <Markdown text={run.notes} />
              <Button small onClick={() => setRead(run.notes)}>I have read it; keep mine</Button>
            </div>
          )}
          <div className={layout.acts} style={{ justifyContent: 'flex-end', marginTop: 10 }}>
            <span className={clsx(layout.grow, 'small mut')}>
              {draft.length > 0.9 * MOST && `${count(MOST - draft.length)} characters left`}
            </span>
            <Button small onClick={() => setDraft(null)}>Discard</Button>
            <Button small main type="submit" disabled={edit.isPending || draft === run.notes}>Save notes</Button>
          </div>
        </form>
      ) : run.notes.trim() ? (
        <Markdown text={run.notes} />
      ) : (
        <p className="mut">No notes yet. State why this run was made, and what was decided on it.</p>
      )}
    </Card>
  )
}

function Markdown({ text }: { text: string }) {
  return (
    <Part>
      <Parsed text={text} />
    </Part>
  )
}
