// Saving the campaign as a draft: the button, the state, and the resolution of conflicts.
import { IconAlertTriangle, IconDeviceFloppy } from '@tabler/icons-react'
import type { Saved } from './useSaved'
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
  const { draft, saving, trouble, overtaken } = saved
  // The error is shown below; the rejected promise needs no further handling.
  const save = (another = false) => void saved.save({ another }).catch(() => undefined)
  const standing = dirty ? 'Unsaved changes.' : draft ? `All changes are saved in ${draft.id}.` : ''
  return (
    <div className={styles.draftbar}>
      <button type="button" className="btn wide" disabled={saving || (draft !== null && !dirty)} onClick={() => save()}>
        <IconDeviceFloppy className="i s" aria-hidden />
        {saving ? 'Saving …' : draft ? `Save ${draft.id}` : 'Save as draft'}
      </button>
      <p className="small mut" aria-live="polite" data-testid="kept">
        {standing}
      </p>
      {draft && (
        <label className="row small">
          <input type="checkbox" checked={remove} onChange={(event) => onRemove(event.target.checked)} />
          Delete {draft.id} once the run is queued
        </label>
      )}
      {trouble && (
        <div className="note bad" role="alert">
          <IconAlertTriangle className="i" aria-hidden />
          <div>
            <p>{trouble.message}</p>
            {overtaken && (
              <div className="acts">
                <button type="button" className="btn s" onClick={() => save(true)}>
                  Keep mine as a new draft
                </button>
                <button type="button" className="btn s" onClick={onReopen}>
                  Open theirs
                </button>
              </div>
            )}
          </div>
        </div>
      )}
    </div>
  )
}
