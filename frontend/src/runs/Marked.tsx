// Actions on the selected runs.
import { IconGitCompare, IconPinned, IconPlayerStop, IconX } from '@tabler/icons-react'
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { useState } from 'react'
import { editRun } from '../api/calls'
import { useChange } from '../api/change'
import { putRun } from '../api/events'
import { useBarredFromOwn } from '../api/may'
import { isLive } from '../api/queries'
import { cancelRuns, type RunSummary } from '../client'
import { MOST, olderFirst } from '../compare/search'
import { count } from '../format/numbers'
import { plural, RemoveMarked, RunNames } from '../run/header/Removal'
import { Button, ButtonLink } from '../ui/Button'
import { Form } from '../ui/Form'
import { IconButton } from '../ui/IconButton'
import { Modal } from '../overlay/Modal'
import { fields } from '../ui/styles'

interface MarkedProps {
  /** The selected ones among the loaded. */
  runs: RunSummary[]
  onClear: () => void
}

export function Marked({ runs, onClear }: MarkedProps) {
  const live = runs.filter((run) => isLive(run) && run.state !== 'cancelling')
  const pinned = runs.every((run) => run.pinned)
  const barred = useBarredFromOwn('engineer', ...runs)
  const pin = useChange(() => Promise.all(runs.map((run) => editRun(run.id, { pinned: !pinned }))), ['runs'])
  return (
    <>
      <span className="small sec nw" role="status">
        {count(runs.length)} selected
      </span>
      {runs.every((run) => run.removed === null) && (
        <Button small icon={IconPinned} onClick={() => pin.mutate()} disabled={pin.isPending} barred={barred}>
          {pinned ? 'Unpin' : 'Pin'}
        </Button>
      )}
      {runs.length > 1 && runs.length <= MOST && (
        <ButtonLink small icon={IconGitCompare} to="/compare" search={{ runs: olderFirst(runs.map((run) => run.id)).join(',') }}>
          Compare {plural(runs.length)}
        </ButtonLink>
      )}
      <CancelMarked key={runs.map((run) => run.id).join()} live={live} />
      <RemoveMarked runs={runs} onDone={onClear} />
      <IconButton bare label="Clear selection" icon={IconX} act={onClear} />
      {pin.isError && <span className={fields.ferr}>{pin.error.message}</span>}
    </>
  )
}

function CancelMarked({ live }: { live: RunSummary[] }) {
  const [asking, setAsking] = useState(false)
  const cache = useQueryClient()
  const cancel = useMutation({
    mutationFn: () => cancelRuns({ body: { runs: live.map((run) => run.id) } }),
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
      <Button small danger icon={IconPlayerStop} disabled={live.length === 0} barred={barred} onClick={() => setAsking(true)}>
        {live.length > 0 ? `Cancel ${plural(live.length)}` : 'Nothing left to cancel'}
      </Button>
      <Modal opened={asking} onClose={() => setAsking(false)} title={`Cancel ${plural(live.length)}?`}>
        <Form
          sent={cancel}
          onSend={() => cancel.mutate()}
          send={`Cancel ${plural(live.length)}`}
          leave="Keep running"
          onLeave={() => setAsking(false)}
          danger
          off={live.length === 0}
        >
          <p className="sec">
            Completed evaluations are stored. A cancelled run has no verdict and cannot be resumed; it can be run again.
          </p>
          <RunNames runs={live} />
        </Form>
      </Modal>
    </>
  )
}
