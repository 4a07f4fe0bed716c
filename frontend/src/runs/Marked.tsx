// Actions on the selected runs.
import { clsx } from 'clsx'
import { IconGitCompare, IconPinned, IconPlayerStop, IconX } from '@tabler/icons-react'
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import { useState } from 'react'
import { cancelRuns, editRun } from '../api/calls'
import { putRun } from '../api/events'
import { useBarredFromOwn } from '../api/may'
import { isLive } from '../api/queries'
import type { RunSummary } from '../client'
import { MOST, olderFirst } from '../compare/search'
import { count } from '../format/numbers'
import { plural, RemoveMarked } from '../run/header/Removal'
import { Modal } from '../ui/Modal'
import buttons from '../ui/buttons.module.css'
import fields from '../ui/fields.module.css'
import layout from '../ui/layout.module.css'
import lists from '../ui/lists.module.css'

interface MarkedProps {
  /** The selected ones among the loaded. */
  runs: RunSummary[]
  onClear: () => void
}

export function Marked({ runs, onClear }: MarkedProps) {
  const live = runs.filter((run) => isLive(run) && run.state !== 'cancelling')
  const pinned = runs.every((run) => run.pinned)
  const cache = useQueryClient()
  const barred = useBarredFromOwn('engineer', ...runs)
  const pin = useMutation({
    mutationFn: () => Promise.all(runs.map((run) => editRun(run.id, { pinned: !pinned }))),
    onSettled: () => cache.invalidateQueries({ queryKey: ['runs'] }),
  })
  return (
    <>
      <span className="small sec nw" role="status">
        {count(runs.length)} selected
      </span>
      {runs.every((run) => run.removed === null) && (
        <button type="button" className={clsx(buttons.btn, buttons.s)} onClick={() => pin.mutate()} disabled={pin.isPending || barred !== undefined} title={barred}>
          <IconPinned className="i s" aria-hidden />
          {pinned ? 'Unpin' : 'Pin'}
        </button>
      )}
      {runs.length > 1 && runs.length <= MOST && (
        <Link to="/compare" search={{ runs: olderFirst(runs.map((run) => run.id)).join(',') }} className={clsx(buttons.btn, buttons.s)}>
          <IconGitCompare className="i s" aria-hidden />
          Compare {plural(runs.length)}
        </Link>
      )}
      <CancelMarked key={runs.map((run) => run.id).join()} live={live} />
      <RemoveMarked runs={runs} onDone={onClear} />
      <button type="button" className={buttons.iconbtn} onClick={onClear} aria-label="Clear selection" title="Clear selection">
        <IconX className="i s" aria-hidden />
      </button>
      {pin.isError && <span className={fields.ferr}>{pin.error.message}</span>}
    </>
  )
}

function CancelMarked({ live }: { live: RunSummary[] }) {
  const [asking, setAsking] = useState(false)
  const cache = useQueryClient()
  const cancel = useMutation({
    mutationFn: () => cancelRuns(live.map((run) => run.id)),
    onSuccess: (summaries) => {
      for (const summary of summaries) putRun(cache, summary)
      setAsking(false)
    },
  })
  // It stays, no narrower, when the last of the selected runs ends: removal must not take its place under the pointer.
  const barred = useBarredFromOwn('engineer', ...live)
  const [offered, setOffered] = useState(false)
  if (live.length > 0 && !offered) setOffered(true)
  if (!offered) return null
  return (
    <>
      <button type="button" className={clsx(buttons.btn, buttons.s, buttons.danger)} disabled={live.length === 0 || barred !== undefined} title={barred} onClick={() => setAsking(true)}>
        <IconPlayerStop className="i s" aria-hidden />
        {live.length > 0 ? `Cancel ${plural(live.length)}` : 'Nothing left to cancel'}
      </button>
      <Modal opened={asking} onClose={() => setAsking(false)} title={`Cancel ${plural(live.length)}?`} centered lockScroll={false}>
        <p className="sec">
          Completed evaluations are stored. A cancelled run has no verdict and cannot be resumed; it can be run again.
        </p>
        <ul className={clsx(lists.listed, 'small sec')}>
          {live.slice(0, 8).map((run) => (
            <li key={run.id}>
              <span className="mono">{run.id}</span> {run.name}
            </li>
          ))}
          {live.length > 8 && <li>and {count(live.length - 8)} more</li>}
        </ul>
        {cancel.isError && <p className={fields.ferr}>{cancel.error.message}</p>}
        <div className={layout.acts} style={{ justifyContent: 'flex-end', marginTop: 16 }}>
          <button type="button" className={buttons.btn} onClick={() => setAsking(false)}>
            Keep running
          </button>
          <button
            type="button"
            className={clsx(buttons.btn, buttons.danger, buttons.p)}
            disabled={cancel.isPending || live.length === 0}
            onClick={() => cancel.mutate()}
          >
            Cancel {plural(live.length)}
          </button>
        </div>
      </Modal>
    </>
  )
}
