// Asks for confirmation before leaving the page or choosing another case with unsaved edits.
import { useBlocker } from '@tanstack/react-router'
import { clsx } from 'clsx'
import { useState } from 'react'
import { Modal } from '../../ui/Modal'
import buttons from '../../ui/buttons.module.css'
import fields from '../../ui/fields.module.css'
import layout from '../../ui/layout.module.css'
import styles from './draft.module.css'

interface Place {
  pathname: string
  search: { case?: string; from?: string; draft?: string }
}

interface LeavingProps {
  dirty: boolean
  /** Whether the editor itself navigates: to its run, or to its own draft. */
  expected: (place: Place) => boolean
  onSave: () => Promise<unknown>
}

/** Another tab of the same editor is the same page. */
const elsewhere = (current: Place, next: Place): boolean =>
  current.pathname !== next.pathname ||
  (['case', 'from', 'draft'] as const).some((key) => current.search[key] !== next.search[key])

export function Leaving({ dirty, expected, onSave }: LeavingProps) {
  const [failed, setFailed] = useState('')
  const blocker = useBlocker({
    shouldBlockFn: ({ current, next }) =>
      dirty && !expected(next as Place) && elsewhere(current as Place, next as Place),
    enableBeforeUnload: () => dirty,
    withResolver: true,
  })
  if (blocker.status !== 'blocked') return null
  const keep = () => void onSave().then(blocker.proceed, (error: Error) => setFailed(error.message))
  return (
    <Modal opened onClose={blocker.reset} title="Unsaved changes" centered lockScroll={false}>
      <div className={fields.panel}>
        <p>Your changes to this campaign are not saved.</p>
        {failed && (
          <p className={fields.ferr} role="alert">
            {failed}
          </p>
        )}
        <div className={clsx(layout.acts, styles.end)}>
          <button type="button" className={buttons.btn} onClick={blocker.reset}>
            Stay
          </button>
          <button type="button" className={buttons.btn} onClick={blocker.proceed}>
            Leave without saving
          </button>
          <button type="button" className={clsx(buttons.btn, buttons.p)} onClick={keep}>
            Save as draft
          </button>
        </div>
      </div>
    </Modal>
  )
}
