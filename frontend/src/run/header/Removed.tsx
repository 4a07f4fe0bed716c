// Notice of a removed run: who, when and why, and restoration; notice of a purged run.
import { clsx } from 'clsx'
import { IconArrowBackUp, IconTrash } from '@tabler/icons-react'
import { useState } from 'react'
import { useBarred } from '../../api/may'
import type { RunDetail } from '../../client'
import { moment } from '../../format/time'
import { Button, ButtonLink } from '../../ui/Button'
import { Digests } from '../../ui/Digests'
import { RemoveDialog, useRestore } from './Removal'
import { History } from './History'
import { cards, fields, layout } from '../../ui/styles'

export function Remove({ run }: { run: RunDetail }) {
  const [asking, setAsking] = useState(false)
  const barred = useBarred('admin')
  return (
    <>
      <Button icon={IconTrash} onClick={() => setAsking(true)} barred={barred}>Remove</Button>
      <RemoveDialog runs={[run]} opened={asking} onClose={() => setAsking(false)} />
    </>
  )
}

export function Removed({ run }: { run: RunDetail }) {
  const restore = useRestore([run])
  const barred = useBarred('admin')
  return (
    <div className={clsx(cards.note, cards.warn)} role="status" style={{ marginBottom: 'var(--gap)', alignItems: 'center' }}>
      <IconTrash className="i" aria-hidden />
      <span className={layout.wrapAny}>
        <b>Removed from the lists</b> by {run.removed_by}, {run.removed !== null && moment(run.removed)}: {run.removed_reason}
        {restore.isError && <span className={fields.ferr}> {restore.error.message}</span>}
      </span>
      <Button small icon={IconArrowBackUp} className={layout.atend} onClick={() => restore.mutate()} disabled={restore.isPending} barred={barred}>
        Restore
      </Button>
    </div>
  )
}

export function Purged({ id, statement }: { id: string; statement: string }) {
  return (
    <>
      <div className={clsx(cards.card, layout.centre)} role="alert" style={{ marginBottom: 'var(--gap)' }}>
        <IconTrash size={36} stroke={1.5} aria-hidden />
        <h1>{id} was purged</h1>
        <p className={layout.wrapAny}><Digests text={statement} /></p>
        <ButtonLink to="/runs">All runs</ButtonLink>
      </div>
      <History run={id} />
    </>
  )
}
