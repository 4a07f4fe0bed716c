// Reviewers' sign-offs on a run's page: who signed which results, whether these are unchanged, signing, withdrawal.
import { clsx } from 'clsx'
import { IconSignature } from '@tabler/icons-react'
import { queryOptions, useQuery } from '@tanstack/react-query'
import { useState } from 'react'
import { useChange } from '../api/change'
import { useBarredFromOwn } from '../api/may'
import { sessionQuery } from '../api/queries'
import { listSignoffs, type RunDetail, type Signoff, type Signoffs, signOff, withdrawSignoff } from '../client'
import { launchedBy } from '../format/people'
import { moment } from '../format/time'
import { Failed } from '../page/Trouble'
import { Button } from '../ui/Button'
import { Field, Form } from '../ui/Form'
import { Card } from '../ui/Card'
import { Digest } from '../ui/Digests'
import { Modal } from '../overlay/Modal'
import { RunLink } from '../ui/RunLink'
import { buttonColumn, Table } from '../ui/Table'
import { headlineOf } from '../ui/VerdictBadge'
import { cards, layout, tables } from '../ui/styles'
import { detailOf, STANDINGS } from './SignedBy'
import styles from './signoffs.module.css'

const sentence = (clause: string) => `${clause.charAt(0).toUpperCase()}${clause.slice(1)}.`

const signoffsQuery = (run: string) =>
  queryOptions({ queryKey: ['signoffs', run], queryFn: () => listSignoffs({ path: { run } }), staleTime: 5_000 })

export function SignoffsCard({ run }: { run: RunDetail }) {
  const { data, error, refetch } = useQuery(signoffsQuery(run.id))
  const barred = data?.barred ? sentence(data.barred) : undefined
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
      className={layout.c6}
      id="signoff"
      flush={(data?.items.length ?? 0) > 0}
      footer={
        data?.can_sign &&
        (barred !== undefined || data.not_carried !== null) && (
          <div className="small mut">
            {data.not_carried !== null && <p>{sentence(data.not_carried)}</p>}
            {barred !== undefined && <p>{barred}</p>}
          </div>
        )
      }
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
      {data && data.items.length > 0 && <Rows run={run.id} items={data.items} onWithdraw={setLeaving} />}
      <Modal opened={signing} onClose={() => setSigning(false)} title={`Sign off ${run.id}`}>
        {signing && data && <SignForm run={run} seen={data} onDone={() => setSigning(false)} />}
      </Modal>
      <Modal opened={leaving !== null} onClose={() => setLeaving(null)} title="Withdraw">
        {leaving && <WithdrawForm run={run.id} signoff={leaving} onDone={() => setLeaving(null)} />}
      </Modal>
    </Card>
  )
}

interface RowsProps {
  run: string
  items: readonly Signoff[]
  onWithdraw: (signoff: Signoff) => void
}

function Rows({ run, items, onWithdraw }: RowsProps) {
  return (
    <Table
      stack
      className={styles.rows}
      rows={items}
      by={({ id }) => id}
      columns={[
        { head: 'Status', label: 'Status', className: clsx(layout.wrapAny, styles.status), cell: (item) => <Status item={item} run={run} /> },
        {
          head: 'Signed by',
          label: 'Signed by',
          cell: ({ name, typed, stated, role }) => (
            <span className={tables.rn}>
              <span className={clsx('m', layout.wrapAny)}>{name}</span>
              <small>{role}</small>
              {typed && <small>name as typed, without an account</small>}
              {stated !== null && <small>name typed then: {stated}</small>}
            </span>
          ),
        },
        {
          head: 'When, signed in as',
          label: 'When',
          cell: ({ created, account, user }) => (
            <span className={tables.rn}>
              <span className="sec">{moment(created)}</span>
              <small className={layout.wrapAny}>{launchedBy({ owner: account, token: user === account ? null : user })}</small>
            </span>
          ),
        },
        { head: 'Comment', label: 'Comment', tone: clsx('sec', styles.comment), cell: ({ comment }) => comment },
        buttonColumn<Signoff>(
          'Withdraw',
          (item) => item.withdrawn === null && item.run === run && <Withdraw item={item} onAsk={() => onWithdraw(item)} />,
        ),
      ]}
    />
  )
}

function Withdraw({ item, onAsk }: { item: Signoff; onAsk: () => void }) {
  const barred = useBarredFromOwn('reviewer', { id: 'This sign-off', owner: item.account })
  return (
    <Button small barred={barred} onClick={onAsk}>Withdraw …</Button>
  )
}

function Status({ item, run }: { item: Signoff; run: string }) {
  const { word, tone, icon: Icon } = STANDINGS[item.standing]
  const other = item.run === run ? item.repeated_by : item.run
  return (
    <span className={clsx(tables.rn, tone)} title={`Signed results: sha256 ${item.digest}`}>
      <span className="nw">
        <Icon className="i s" aria-hidden /> {word}
        {other !== null && other !== run && (
          <>
            {item.run === run ? ' by ' : ' from '}
            <RunLink run={other} />
          </>
        )}
      </span>
      <small>{detailOf(item)}</small>
    </span>
  )
}

const TITLES = ['Independent review', 'Safety engineer', 'Safety authority', 'Prepared']

/** How another run speaks against the verdict. */
const WAYS: Record<string, string> = {
  violates: 'violates the criterion',
  found: 'found a value at or below the threshold',
  beyond: 'saw beyond the horizon what bars a cleared verdict',
}

/** All of them, those that do so in the same way together. */
const stated = (against: Signoffs['against']) =>
  [...new Set(Object.values(against))]
    .map((way) => {
      const ids = Object.keys(against).filter((id) => against[id] === way)
      const text = WAYS[way] ?? way
      return `${ids.join(', ')} ${ids.length > 1 ? text.replace(/^violates/, 'violate') : text}`
    })
    .join('; ')

interface SignFormProps {
  run: RunDetail
  /** Summary of exactly what is signed. */
  seen: Signoffs
  onDone: () => void
}

export function SignForm({ run, seen, onDone }: SignFormProps) {
  const session = useQuery(sessionQuery).data
  const [name, setName] = useState('')
  const own = session !== undefined && session.account === run.owner
  const account = seen.signs_as
  // Whoever launched a run is not independent of it.
  const [role, setRole] = useState(own ? '' : (TITLES[0] ?? ''))
  const [comment, setComment] = useState('')
  const [{ digest, texts, against }, setRead] = useState(seen)
  const other = digest !== seen.digest || JSON.stringify([texts, against]) !== JSON.stringify([seen.texts, seen.against])
  const contradicted = Object.keys(against).length > 0
  const sign = useChange(
    () => signOff({ path: { run: run.id }, body: { ...(account === null && { name: name.trim() }), role: role.trim(), comment: comment.trim(), digest, texts, against } }),
    ['signoffs'],
    onDone,
  )
  return (
    <Form sent={sign} onSend={() => sign.mutate()} send="Sign off" onLeave={onDone} off={(account === null && !name.trim()) || !role.trim() || (contradicted && !comment.trim())}>
      <p className="sec">
        You sign the verdict <b>{headlineOf(run)}</b> with its findings and stages, sha256{' '}
        <span className="mono">{digest.slice(0, 16)}</span>
        {account !== null && (
          <>
            , as <b>{account}</b>
          </>
        )}
        . This cannot be edited later, only withdrawn.
        {account === null && ' This service has no accounts: the name is recorded as typed.'}
        {own && ` You launched ${run.id}, and the sign-off states that.`}
      </p>
      <Texts of={texts} />
      {contradicted && (
        <p className={cards.note}>
          <b>{stated(against)}.</b> State in the comment why these results
          are signed off all the same: the sign-off then stands, until another run speaks against them.
        </p>
      )}
      {sign.isError && other && (
        <div className={cards.note} role="status">
          <p>
            <b>It is now:</b> sha256 <span className="mono">{seen.digest.slice(0, 16)}</span>
          </p>
          <Texts of={seen.texts} />
          {(contradicted || Object.keys(seen.against).length > 0) && (
            <p>{stated(seen.against) || 'No other run speaks against the verdict now'}.</p>
          )}
          <Button
            small
            onClick={() => {
              setRead(seen)
              sign.reset()
            }}
          >
            I have read it
          </Button>
        </div>
      )}
      {account === null && <Field label="Name" value={name} maxLength={120} required data-autofocus onChange={setName} />}
      <Field label="Title" value={role} maxLength={120} required list="signoff-titles" onChange={setRole} />
      <datalist id="signoff-titles">
        {TITLES.map((known) => (
          <option key={known} value={known} />
        ))}
      </datalist>
      <Field label={contradicted ? 'Comment: why it is signed off all the same' : 'Comment'} value={comment} maxLength={4000} rows={4} required={contradicted} onChange={setComment} />
    </Form>
  )
}

/** The texts of requirements that the sign-off is bound to. */
function Texts({ of }: { of: Signoffs['texts'] }) {
  if (Object.keys(of).length === 0) return null
  return (
    <dl className={styles.texts} aria-label="Requirements, with the texts that are signed">
      {Object.entries(of).map(([id, text]) => (
        <div key={id}>
          <dt className="b">{id}</dt>
          <dd>{text || 'no text'}</dd>
        </div>
      ))}
    </dl>
  )
}

function WithdrawForm({ run, signoff, onDone }: { run: string; signoff: Signoff; onDone: () => void }) {
  const [reason, setReason] = useState('')
  const withdraw = useChange(() => withdrawSignoff({ path: { run, signoff: signoff.id }, body: { reason: reason.trim() } }), ['signoffs'], onDone)
  return (
    <Form sent={withdraw} onSend={() => withdraw.mutate()} send="Withdraw" leave="Keep it" onLeave={onDone} danger off={!reason.trim()}>
      <p className="sec">
        The sign-off of {signoff.name} ({signoff.role}) stays on record, with the reason that you give.
      </p>
      <Field label="Reason" value={reason} maxLength={4000} rows={3} required data-autofocus onChange={setReason} />
    </Form>
  )
}
