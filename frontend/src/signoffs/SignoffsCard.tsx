// Reviewers' sign-offs on a run's page: who signed which results, whether these are unchanged, signing, withdrawal.
import { clsx } from 'clsx'
import { IconCircleCheck, IconCircleX, IconSignature } from '@tabler/icons-react'
import { queryOptions, useMutation, useQuery, useQueryClient } from '@tanstack/react-query'
import { useState } from 'react'
import { getSignoffs, signOff, withdrawSignoff } from '../api/calls'
import { useBarredFromOwn } from '../api/may'
import { sessionQuery } from '../api/queries'
import type { RunDetail, Signoff, Signoffs } from '../client'
import { moment } from '../format/time'
import { Failed } from '../page/Trouble'
import { Button } from '../ui/Button'
import { Field, Form } from '../ui/Form'
import { Card } from '../ui/Card'
import { Digest } from '../ui/Digests'
import { Modal } from '../ui/Modal'
import { hiddenHead, Table } from '../ui/Table'
import layout from '../ui/layout.module.css'
import tables from '../ui/tables.module.css'
import styles from './signoffs.module.css'

const signoffsQuery = (run: string) =>
  queryOptions({ queryKey: ['signoffs', run], queryFn: () => getSignoffs(run), staleTime: 5_000 })

export function SignoffsCard({ run, className }: { run: RunDetail; className: string | undefined }) {
  const { data, error, refetch } = useQuery(signoffsQuery(run.id))
  const barred = data?.barred ? `${data.barred.charAt(0).toUpperCase()}${data.barred.slice(1)}.` : undefined
  const [signing, setSigning] = useState(false)
  const [leaving, setLeaving] = useState<Signoff | null>(null)
  return (
    <Card
      title="Sign-off"
      note={
        data && (
          <>
            Bound to these results, sha256 <Digest of={data.digest} />
          </>
        )
      }
      className={className}
      id="signoff"
      flush={(data?.items.length ?? 0) > 0}
      footer={data?.can_sign && barred !== undefined && <p className="small mut">{barred}</p>}
      right={
        data?.can_sign && (
          <Button small icon={IconSignature} onClick={() => setSigning(true)} barred={barred}>Sign off</Button>
        )
      }
    >
      {!data && !error && <p className="mut">Loading the sign-offs …</p>}
      {!data && error && <Failed error={error} retry={() => void refetch()} />}
      {data && data.items.length === 0 && (
        <p className="sec">
          {data.can_sign
            ? 'These results have not been signed off yet. A sign-off names the results that were reviewed and cannot be edited, only withdrawn with a reason.'
            : run.removed === null
              ? 'There is no verdict to sign off.'
              : 'A removed run cannot be signed off.'}
        </p>
      )}
      {data && data.items.length > 0 && <Rows items={data.items} onWithdraw={setLeaving} />}
      <Modal opened={signing} onClose={() => setSigning(false)} title={`Sign off ${run.id}`}>
        {signing && data && <SignForm run={run} seen={data} onDone={() => setSigning(false)} />}
      </Modal>
      <Modal opened={leaving !== null} onClose={() => setLeaving(null)} title="Withdraw">
        {leaving && <WithdrawForm run={run.id} signoff={leaving} onDone={() => setLeaving(null)} />}
      </Modal>
    </Card>
  )
}

function Rows({ items, onWithdraw }: { items: readonly Signoff[]; onWithdraw: (signoff: Signoff) => void }) {
  return (
    <Table
      stack
      className={styles.rows}
      rows={items}
      by={({ id }) => id}
      columns={[
        { head: 'Status', cell: (item) => <Standing item={item} /> },
        {
          head: 'Name, role',
          label: 'Name, role',
          cell: ({ name, role }) => (
            <span className={tables.rn}>
              <span className={clsx('m', layout.wrapAny)}>{name}</span>
              <small>{role}</small>
            </span>
          ),
        },
        {
          head: 'When, signed in as',
          label: 'When',
          cell: ({ created, user, own }) => (
            <span className={tables.rn}>
              <span className="sec">{moment(created)}</span>
              <small className={layout.wrapAny}>{user}</small>
              {own && <small className="unk-t">who also launched the run</small>}
            </span>
          ),
        },
        { head: 'Comment', label: 'Comment', tone: clsx('sec', styles.comment), cell: (item) => <Comment item={item} /> },
        {
          head: hiddenHead('Withdraw'),
          tone: 'num',
          cell: (item) => item.withdrawn === null && <Withdraw item={item} onAsk={() => onWithdraw(item)} />,
        },
      ]}
    />
  )
}

function Comment({ item: { comment, withdrawn, withdrawn_by, withdrawn_reason } }: { item: Signoff }) {
  return (
    <>
      {comment}
      {withdrawn !== null && (
        <span className="bad-t">
          Withdrawn {moment(withdrawn)} by {withdrawn_by}: {withdrawn_reason}
        </span>
      )}
    </>
  )
}

function Withdraw({ item, onAsk }: { item: Signoff; onAsk: () => void }) {
  const barred = useBarredFromOwn('reviewer', { id: 'This sign-off', owner: item.user })
  return (
    <Button small barred={barred} onClick={onAsk}>Withdraw …</Button>
  )
}

function Standing({ item }: { item: Signoff }) {
  const good = item.current && item.withdrawn === null
  const Icon = good ? IconCircleCheck : IconCircleX
  const words = item.withdrawn !== null ? 'Withdrawn' : item.current ? 'Valid' : 'Results have changed'
  return (
    <span className={good ? 'ok-t nw' : 'bad-t'} title={`Signed results: sha256 ${item.digest}`}>
      <Icon className="i s" aria-hidden /> {words}
    </span>
  )
}

function useChange<T>(run: string, call: (body: T) => Promise<unknown>, onDone: () => void) {
  const cache = useQueryClient()
  return useMutation({
    mutationFn: call,
    onSuccess: async () => {
      await cache.invalidateQueries({ queryKey: ['signoffs', run] })
      onDone()
    },
  })
}

const ROLES = ['Independent review', 'Safety engineer', 'Safety authority', 'Prepared']

interface SignFormProps {
  run: RunDetail
  /** Summary of exactly what is signed. */
  seen: Signoffs
  onDone: () => void
}

function SignForm({ run, seen, onDone }: SignFormProps) {
  const session = useQuery(sessionQuery).data
  const [name, setName] = useState('')
  const own = session !== undefined && session.user === run.owner
  // Whoever launched a run is not independent of it.
  const [role, setRole] = useState(own ? '' : (ROLES[0] ?? ''))
  const [comment, setComment] = useState('')
  const [digest] = useState(seen.digest)
  const sign = useChange(
    run.id,
    () => signOff(run.id, { name: name.trim(), role: role.trim(), comment: comment.trim(), digest }),
    onDone,
  )
  return (
    <Form sent={sign} onSend={() => sign.mutate(undefined)} send="Sign off" onLeave={onDone} off={!name.trim() || !role.trim()}>
      <p className="sec">
        You sign the verdict <b>{run.verdict}</b> with its findings and stages, sha256{' '}
        <span className="mono">{digest.slice(0, 16)}</span>
        {session && <>, signed in as {session.user}</>}. This cannot be edited later, only withdrawn.
        {own && ` You launched ${run.id}, and the sign-off states that.`}
      </p>
      <Field label="Name" value={name} maxLength={120} required data-autofocus onChange={setName} />
      <Field label="Role" value={role} maxLength={120} required list="signoff-roles" onChange={setRole} />
      <datalist id="signoff-roles">
        {ROLES.map((known) => (
          <option key={known} value={known} />
        ))}
      </datalist>
      <Field label="Comment" value={comment} maxLength={4000} rows={4} onChange={setComment} />
    </Form>
  )
}

function WithdrawForm({ run, signoff, onDone }: { run: string; signoff: Signoff; onDone: () => void }) {
  const [reason, setReason] = useState('')
  const withdraw = useChange(run, () => withdrawSignoff(run, signoff.id, reason.trim()), onDone)
  return (
    <Form sent={withdraw} onSend={() => withdraw.mutate(undefined)} send="Withdraw" leave="Keep it" onLeave={onDone} danger off={!reason.trim()}>
      <p className="sec">
        The sign-off of {signoff.name} ({signoff.role}) stays on record, with the reason that you give.
      </p>
      <Field label="Reason" value={reason} maxLength={4000} rows={3} required data-autofocus onChange={setReason} />
    </Form>
  )
}
