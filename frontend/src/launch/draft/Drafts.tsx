// The drafts stored on the service: user, time, open, delete.
import { IconTrash } from '@tabler/icons-react'
import { useMutation, useQuery, useQueryClient } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import { clsx } from 'clsx'
import { useState } from 'react'
import { deleteDraft } from '../../api/calls'
import { useBarredFromOwn } from '../../api/may'
import { draftsQuery } from '../../api/queries'
import type { DraftSummary } from '../../client'
import { count } from '../../format/numbers'
import { moment, when } from '../../format/time'
import { Card, Tags } from '../../ui/Card'
import { Modal } from '../../ui/Modal'
import { useNow } from '../../ui/useNow'
import buttons from '../../ui/buttons.module.css'
import fields from '../../ui/fields.module.css'
import layout from '../../ui/layout.module.css'
import tables from '../../ui/tables.module.css'
import styles from './draft.module.css'

const FEW = 4

export function Drafts() {
  const { data } = useQuery(draftsQuery)
  const [all, setAll] = useState(false)
  const [leaving, setLeaving] = useState<DraftSummary | null>(null)
  const now = useNow(30_000)
  if (!data || data.length === 0) return null
  const shown = all ? data : data.slice(0, FEW)
  return (
    <Card
      title="Drafts"
      note="Saved campaigns that have not been started."
      className={styles.drafts}
      flush
      footer={
        shown.length < data.length && (
          <button type="button" className={buttons.linkbtn} onClick={() => setAll(true)}>
            Show {count(data.length - shown.length)} more
          </button>
        )
      }
    >
      <table className={clsx(tables.table, tables.stack)}>
        <thead>
          <tr>
            <th>Draft</th>
            <th>Name</th>
            <th className={layout.hideN}>Tags</th>
            <th>Saved by</th>
            <th>Saved</th>
            <th>Run</th>
            <th aria-label="Delete" />
          </tr>
        </thead>
        <tbody>
          {shown.map((draft) => (
            <tr key={draft.id}>
              <td>
                <Link to="/launch" search={{ draft: draft.id }} className="mono nw">
                  {draft.id}
                </Link>
              </td>
              <td className={layout.wrapAny} data-label="Name">{draft.name || <span className="mut">Untitled</span>}</td>
              <td className={layout.hideN} data-label={draft.tags.length > 0 ? 'Tags' : undefined}>
                <Tags tags={draft.tags} />
              </td>
              <td data-label="Saved by">
                {draft.saved_by}
                {draft.owner !== draft.saved_by && <span className="mut">, begun by {draft.owner}</span>}
              </td>
              <td className="nw" title={moment(draft.saved)} data-label="Saved">
                {when(draft.saved, now)}
              </td>
              <td data-label={draft.run ? 'Run' : undefined}>
                {draft.run && (
                  <Link to="/runs/$id" params={{ id: draft.run }} className="mono">
                    {draft.run}
                  </Link>
                )}
              </td>
              <td className={layout.acts}>
                <Delete draft={draft} onAsk={() => setLeaving(draft)} />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      <Modal
        opened={leaving !== null}
        onClose={() => setLeaving(null)}
        title={`Delete draft ${leaving?.id ?? ''}`}
        centered
        lockScroll={false}
      >
        {leaving && <Deletion draft={leaving} onDone={() => setLeaving(null)} />}
      </Modal>
    </Card>
  )
}

function Delete({ draft, onAsk }: { draft: DraftSummary; onAsk: () => void }) {
  const barred = useBarredFromOwn('engineer', draft)
  return (
    <button
      type="button"
      className={buttons.iconbtn}
      aria-label={`Delete draft ${draft.id}`}
      title={barred ?? 'Delete'}
      disabled={barred !== undefined}
      onClick={onAsk}
    >
      <IconTrash className="i s" aria-hidden />
    </button>
  )
}

function Deletion({ draft, onDone }: { draft: DraftSummary; onDone: () => void }) {
  const cache = useQueryClient()
  const removal = useMutation({
    mutationFn: () => deleteDraft(draft.id, draft.version),
    onSuccess: onDone,
    onSettled: () => cache.invalidateQueries({ queryKey: ['drafts'] }),
  })
  return (
    <div className={fields.panel}>
      <p>
        {draft.name || 'This untitled draft'} will be deleted for all users. Runs started from it remain.
      </p>
      {removal.error && (
        <p className={fields.ferr} role="alert">
          {removal.error.message}
        </p>
      )}
      <div className={clsx(layout.acts, styles.end)}>
        <button type="button" className={buttons.btn} onClick={onDone}>
          Keep it
        </button>
        <button type="button" className={clsx(buttons.btn, buttons.p)} disabled={removal.isPending} onClick={() => removal.mutate()}>
          Delete
        </button>
      </div>
    </div>
  )
}
