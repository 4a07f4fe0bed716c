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
import { Modal } from '../../ui/Modal'
import buttons from '../../ui/buttons.module.css'
import fields from '../../ui/fields.module.css'
import layout from '../../ui/layout.module.css'
import lists from '../../ui/lists.module.css'

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
        <button type="button" className={clsx(buttons.btn, buttons.s)} onClick={() => setAsking(true)} disabled={barred !== undefined} title={barred}>
          <IconTrash className="i s" aria-hidden />
          Remove {plural(over.length)}
        </button>
      )}
      {gone.length > 0 && (
        <button type="button" className={clsx(buttons.btn, buttons.s)} onClick={() => restore.mutate()} disabled={restore.isPending || barred !== undefined} title={barred}>
          <IconArrowBackUp className="i s" aria-hidden />
          Restore {plural(gone.length)}
        </button>
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
    <Modal opened={opened && runs.length > 0} onClose={onClose} title={`Remove ${what}?`} centered lockScroll={false}>
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
    <form
      className={fields.panel}
      onSubmit={(event) => {
        event.preventDefault()
        remove.mutate()
      }}
    >
      <p className="sec">
        {runs.length === 1 ? 'It leaves' : 'They leave'} every list, count and search. Results, history and address stay, and
        removal can be undone until the run is purged.
      </p>
      {runs.length > 1 && (
        <ul className={clsx(lists.listed, 'small sec')}>
          {runs.slice(0, 8).map((run) => (
            <li key={run.id}>
              <span className="mono">{run.id}</span> {run.name}
            </li>
          ))}
          {runs.length > 8 && <li>and {count(runs.length - 8)} more</li>}
        </ul>
      )}
      {Boolean(staying) && (
        <p className="small sec">{plural(staying ?? 0)} of the selection still running: cancel first to remove them.</p>
      )}
      <label className={fields.lbl}>
        Reason
        <textarea
          className={clsx(fields.inp, fields.area)}
          value={reason}
          maxLength={400}
          rows={2}
          required
          data-autofocus
          onChange={(event) => setReason(event.target.value)}
        />
      </label>
      {remove.isError && <p className={fields.ferr}>{remove.error.message}</p>}
      <div className={layout.acts} style={{ justifyContent: 'flex-end' }}>
        <button type="button" className={buttons.btn} onClick={onClose}>
          {runs.length === 1 ? 'Keep it' : 'Keep them'}
        </button>
        <button type="submit" className={clsx(buttons.btn, buttons.danger, buttons.p)} disabled={remove.isPending || !reason.trim()}>
          Remove {runs.length === 1 ? 'run' : plural(runs.length)}
        </button>
      </div>
    </form>
  )
}
