// Asks for confirmation before leaving the page or choosing another case with unsaved edits.
import { useBlocker } from '@tanstack/react-router'
import { useState } from 'react'
import { DialogForm } from '../../ui/DialogForm'
import { Modal } from '../../ui/Modal'
import buttons from '../../ui/buttons.module.css'

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
  const [failed, setFailed] = useState<Error | null>(null)
  const blocker = useBlocker({
    shouldBlockFn: ({ current, next }) =>
      dirty && !expected(next as Place) && elsewhere(current as Place, next as Place),
    enableBeforeUnload: () => dirty,
    withResolver: true,
  })
  if (blocker.status !== 'blocked') return null
  const keep = () => void onSave().then(blocker.proceed, setFailed)
  return (
    <Modal opened onClose={blocker.reset} title="Unsaved changes">
      <DialogForm
        error={failed}
        submit="Save as draft"
        onSubmit={keep}
        leave="Stay"
        onLeave={blocker.reset}
        more={
          <button type="button" className={buttons.btn} onClick={blocker.proceed}>
            Leave without saving
          </button>
        }
      >
        <p>Your changes to this campaign are not saved.</p>
      </DialogForm>
    </Modal>
  )
}
