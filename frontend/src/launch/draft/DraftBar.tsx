// Saving the campaign as a draft: the button, the state, and the resolution of conflicts.
import { clsx } from 'clsx'
import { IconAlertTriangle, IconDeviceFloppy } from '@tabler/icons-react'
import { useBarred } from '../../api/may'
import type { Saved } from './useSaved'
import { Button } from '../../ui/Button'
import { cards, fields, layout } from '../../ui/styles'
import styles from './draft.module.css'

interface DraftBarProps {
  saved: Saved
  dirty: boolean
  /** Whether the draft is deleted once the run is queued. */
  remove: boolean
  onRemove: (remove: boolean) => void
  onReopen: () => void
}

export function DraftBar({ saved, dirty, remove, onRemove, onReopen }: DraftBarProps) {
  const { draft, foreign, saving, trouble, overtaken, gone } = saved
  const barred = useBarred('engineer')
  // The error is shown below; the rejected promise needs no further handling.
  const save = (another = false) => void saved.save({ another }).catch(() => undefined)
  const standing = draft && foreign ? `${draft.id} belongs to ${draft.owner}: saving makes a new draft.` : dirty ? 'Unsaved changes.' : draft ? `All changes are saved in ${draft.id}.` : ''
  return (
    <div className={styles.draftbar}>
      <Button wide icon={IconDeviceFloppy} disabled={saving || (draft !== null && !dirty && !foreign)} barred={barred} onClick={() => save()}>
        {saving ? 'Saving …' : draft && !foreign ? `Save ${draft.id}` : foreign ? 'Save as a new draft' : 'Save as draft'}
      </Button>
      <p className="small mut" aria-live="polite" data-testid="kept">
        {standing}
      </p>
      {draft && !foreign && (
        <label className={clsx(layout.row, 'small')}>
          <input className={fields.check} type="checkbox" checked={remove} onChange={(event) => onRemove(event.target.checked)} />
          Delete {draft.id} once the run is queued
        </label>
      )}
      {trouble && (
        <div className={clsx(cards.note, cards.bad)} role="alert">
          <IconAlertTriangle className="i" aria-hidden />
          <div>
            <p>{trouble.message}</p>
            {overtaken && (
              <div className={clsx(layout.acts, styles.acts)}>
                <Button small onClick={() => save(true)}>Keep mine as a new draft</Button>
                {!gone && <Button small onClick={onReopen}>Open theirs</Button>}
              </div>
            )}
          </div>
        </div>
      )}
    </div>
  )
}
