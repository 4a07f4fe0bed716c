// Notice of a removed run: who, when and why, and restoration; notice of a purged run.
import { IconArrowBackUp, IconTrash } from '@tabler/icons-react'
import { Link } from '@tanstack/react-router'
import { useState } from 'react'
import type { RunDetail } from '../../client'
import { moment } from '../../format/time'
import { RemoveDialog, useRestore } from './Removal'
import { History } from './History'

export function Remove({ run }: { run: RunDetail }) {
  const [asking, setAsking] = useState(false)
  return (
    <>
      <button type="button" className="btn" onClick={() => setAsking(true)}>
        <IconTrash className="i s" aria-hidden />
        Remove
      </button>
      <RemoveDialog runs={[run]} opened={asking} onClose={() => setAsking(false)} />
    </>
  )
}

export function Removed({ run }: { run: RunDetail }) {
  const restore = useRestore([run])
  return (
    <div className="note warn" role="status" style={{ marginBottom: 'var(--gap)', alignItems: 'center' }}>
      <IconTrash className="i" aria-hidden />
      <span className="wrap-any">
        <b>Removed from the lists</b> by {run.removed_by}, {run.removed !== null && moment(run.removed)}: {run.removed_reason}
        {restore.isError && <span className="ferr"> {restore.error.message}</span>}
      </span>
      <button
        type="button"
        className="btn s atend"
        onClick={() => restore.mutate()}
        disabled={restore.isPending}
      >
        <IconArrowBackUp className="i s" aria-hidden /> Restore
      </button>
    </div>
  )
}

export function Purged({ id, said }: { id: string; said: string }) {
  return (
    <>
      <div className="card centre" role="alert" style={{ marginBottom: 'var(--gap)' }}>
        <IconTrash size={36} stroke={1.5} aria-hidden />
        <h1>{id} was purged</h1>
        <p className="wrap-any">{said}.</p>
        <Link to="/runs" className="btn">
          All runs
        </Link>
      </div>
      <History run={id} />
    </>
  )
}
