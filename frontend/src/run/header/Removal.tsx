// Removal and restoration of runs: the buttons of a selection, and the dialog that asks for a reason.
import { clsx } from 'clsx'
import { IconArrowBackUp, IconTrash } from '@tabler/icons-react'
import { type QueryClient, useMutation, useQueryClient } from '@tanstack/react-query'
import { useState } from 'react'
import { removeRuns, restoreRuns } from '../../api/calls'
import { useBarred } from '../../api/may'
import { isLive } from '../../api/queries'
import type { RunDetail, RunSummary } from '../../client'
import { count } from '../../format/numbers'
import { Button } from '../../ui/Button'
import { Field, Form } from '../../ui/Form'
import { Modal } from '../../overlay/Modal'
import { fields, lists } from '../../ui/styles'

export const plural = (n: number): string => `${count(n)} ${n === 1 ? 'run' : 'runs'}`

/** Updates changed runs everywhere: lists and their filter values are requested again. */
function putMoved(cache: QueryClient, runs: readonly RunSummary[]): void {
  for (const run of runs) {
    const before = cache.getQueryData<RunDetail>(['run', run.id])
    if (before) cache.setQueryData<RunDetail>(['run', run.id], { ...before, ...run })
    for (const key of ['history', 'signoffs']) void cache.invalidateQueries({ queryKey: [key, run.id] })
  }
  for (const key of ['runs', 'facets', 'jump']) void cache.invalidateQueries({ queryKey: [key] })
}

export function useRestore(runs: readonly RunSummary[], onDone?: () => void) {
  const cache = useQueryClient()
  return useMutation({
    mutationFn: () => restoreRuns(runs.map((run) => run.id)),
    onSuccess: (restored) => {
      putMoved(cache, restored)
      onDone?.()
    },
  })
}

export function RemoveMarked({ runs, onDone }: { runs: readonly RunSummary[]; onDone: () => void }) {
  const [asking, setAsking] = useState(false)
  const over = runs.filter((run) => !isLive(run) && run.removed === null)
  const gone = runs.filter((run) => run.removed !== null)
  const restore = useRestore(gone, onDone)
  const barred = useBarred('admin')
  return (
    <>
      {over.length > 0 && (
        <Button small icon={IconTrash} onClick={() => setAsking(true)} barred={barred}>
          Remove {plural(over.length)}
        </Button>
      )}
      {gone.length > 0 && (
        <Button small icon={IconArrowBackUp} onClick={() => restore.mutate()} disabled={restore.isPending} barred={barred}>
          Restore {plural(gone.length)}
        </Button>
      )}
      {restore.isError && <span className={fields.ferr}>{restore.error.message}</span>}
      <RemoveDialog
        runs={over}
        staying={runs.length - over.length}
        opened={asking}
        onClose={() => setAsking(false)}
        onDone={onDone}
      />
    </>
  )
}

interface RemoveDialogProps {
  runs: readonly RunSummary[]
  /** Selected runs that are still active. */
  staying?: number
  opened: boolean
  onClose: () => void
  onDone?: () => void
}

export function RemoveDialog({ runs, staying = 0, opened, onClose, onDone }: RemoveDialogProps) {
  const what = runs.length === 1 && runs[0] ? runs[0].id : plural(runs.length)
  return (
    <Modal opened={opened && runs.length > 0} onClose={onClose} title={`Remove ${what}?`}>
      {opened && <RemoveForm runs={runs} staying={staying} onClose={onClose} onDone={onDone} />}
    </Modal>
  )
}

function RemoveForm({ runs, staying, onClose, onDone }: Omit<RemoveDialogProps, 'opened'>) {
  const [reason, setReason] = useState('')
  const cache = useQueryClient()
  const remove = useMutation({
    mutationFn: () => removeRuns(runs.map((run) => run.id), reason.trim()),
    onSuccess: (removed) => {
      putMoved(cache, removed)
      onClose()
      onDone?.()
    },
  })
  return (
    <Form
      sent={remove}
      onSend={() => remove.mutate()}
      send={`Remove ${runs.length === 1 ? 'run' : plural(runs.length)}`}
      leave={runs.length === 1 ? 'Keep it' : 'Keep them'}
      onLeave={onClose}
      danger
      off={!reason.trim()}
    >
      <p className="sec">
        {runs.length === 1 ? 'It leaves' : 'They leave'} the lists, their counts and the search. It still counts among the runs of the same
        question. Results, history and address stay, and removal can be undone until the run is purged.
      </p>
      {runs.length > 1 && <RunNames runs={runs} />}
      {Boolean(staying) && (
        <p className="small sec">{plural(staying ?? 0)} of the selection still running: cancel first to remove them.</p>
      )}
      <Field label="Reason" value={reason} maxLength={400} rows={2} required data-autofocus onChange={setReason} />
    </Form>
  )
}

/** The first of the runs that a dialog is about. */
export const RunNames = ({ runs }: { runs: readonly RunSummary[] }) => (
  <ul className={clsx(lists.listed, 'small sec')}>
    {runs.slice(0, 8).map((run) => (
      <li key={run.id}>
        <span className="mono">{run.id}</span> {run.name}
      </li>
    ))}
    {runs.length > 8 && <li>and {count(runs.length - 8)} more</li>}
  </ul>
)
