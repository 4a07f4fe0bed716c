// Asks for confirmation before leaving the page or choosing another case with unsaved edits.
import { useMutation } from '@tanstack/react-query'
import { useBlocker } from '@tanstack/react-router'
import { Button } from '../../ui/Button'
import { Form } from '../../ui/Form'
import { Modal } from '../../overlay/Modal'

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
  const blocker = useBlocker({
    shouldBlockFn: ({ current, next }) =>
      dirty && !expected(next as Place) && elsewhere(current as Place, next as Place),
    enableBeforeUnload: () => dirty,
    withResolver: true,
  })
  const keep = useMutation({ mutationFn: onSave, onSuccess: () => blocker.proceed?.() })
  if (blocker.status !== 'blocked') return null
  return (
    <Modal opened onClose={blocker.reset} title="Unsaved changes">
      <Form
        sent={keep}
        send="Save as draft"
        onSend={() => keep.mutate()}
        leave="Stay"
        onLeave={blocker.reset}
        more={<Button onClick={blocker.proceed}>Leave without saving</Button>}
      >
        <p>Your changes to this campaign are not saved.</p>
      </Form>
    </Modal>
  )
}
