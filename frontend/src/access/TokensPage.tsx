// API tokens: your own, for administrators all; creating and revoking.
import { clsx } from 'clsx'
import { IconKey } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { useState } from 'react'
import { hasRole, tokensQuery } from '../api/access'
import { useChange } from '../api/change'
import { sessionQuery } from '../api/queries'
import { createToken, revokeToken, type Token } from '../client'
import { moment, when } from '../format/time'
import { Loaded } from '../page/Trouble'
import { Button } from '../ui/Button'
import { Card } from '../ui/Card'
import { buttonColumn, type Column, Table, timeColumn } from '../ui/Table'
import { Form } from '../ui/Form'
import { Modal } from '../overlay/Modal'
import { AccessFrame } from './AccessFrame'
import { MakingForm, MayChoice } from './MakingForm'
import { Secret } from './Secret'
import styles from './access.module.css'
import { fields } from '../ui/styles'

const SCOPES = [
  { value: 'read', may: 'reads everything', least: 'viewer' },
  { value: 'run', may: 'also launches, cancels and edits what is yours: for clearance submit', least: 'engineer' },
  { value: 'admin', may: 'everything that you may', least: 'admin' },
] as const

const LIFETIMES = [
  { days: 30, name: '30 days' },
  { days: 90, name: '90 days' },
  { days: 365, name: 'a year' },
  { days: null, name: 'never' },
] as const

export function TokensPage() {
  const tokens = useQuery(tokensQuery)
  const [creating, setCreating] = useState(false)
  const [leaving, setLeaving] = useState<Token | null>(null)
  return (
    <AccessFrame
      title="API tokens"
      actions={
        tokens.data && (
          <Button main icon={IconKey} onClick={() => setCreating(true)}>New token</Button>
        )
      }
    >
      <Loaded query={tokens} what="tokens">
        {(data) => (
          <Card title="Tokens" note="A token never has more than its owner's role" flush={data.length > 0}>
            {data.length === 0 ? (
              <p className="sec">
                There are no tokens. A program sends one as <code>Authorization: Bearer TOKEN</code>; for the command line put it into{' '}
                <code>CLEARANCE_TOKEN</code>.
              </p>
            ) : (
              <TokensList tokens={data} onRevoke={setLeaving} />
            )}
          </Card>
        )}
      </Loaded>
      <Modal opened={creating} onClose={() => setCreating(false)} title="New API token">
        {creating && <CreateForm onDone={() => setCreating(false)} />}
      </Modal>
      <Modal opened={leaving !== null} onClose={() => setLeaving(null)} title={`Revoke ${leaving?.name ?? ''}`}>
        {leaving && <RevokeForm token={leaving} onDone={() => setLeaving(null)} />}
      </Modal>
    </AccessFrame>
  )
}

function TokensList({ tokens, onRevoke }: { tokens: readonly Token[]; onRevoke: (token: Token) => void }) {
  const columns: Column<Token>[] = [
    { head: 'Name', tone: clsx('m', styles.who), cell: ({ name }) => name },
    { head: 'Owner', tone: styles.who, label: 'Owner', cell: ({ owner }) => owner },
    { head: 'Scope', label: 'Scope', cell: ({ scope }) => scope },
    { head: 'State', tone: 'nw', label: 'State', cell: (token) => <State token={token} /> },
    timeColumn('Created', ({ created }) => created, ({ created }) => when(created)),
    timeColumn('Last use', ({ last_used: last }) => last, ({ last_used: last }) => (last === null ? 'never' : when(last))),
    buttonColumn('Revoke', (token) =>
      token.state === 'active' && (
        <Button small aria-label={`Revoke ${token.name}`} onClick={() => onRevoke(token)}>Revoke …</Button>
      ),
    ),
  ]
  return <Table stack rows={tokens} by={({ name }) => name} columns={columns} />
}

function State({ token }: { token: Token }) {
  if (token.revoked !== null) return <span className="bad-t">revoked {moment(token.revoked)}</span>
  if (token.expires === null) return <span className="sec">active, does not expire</span>
  return token.state === 'expired' ? (
    <span className="bad-t">expired {moment(token.expires)}</span>
  ) : (
    <span className="sec">active until {moment(token.expires)}</span>
  )
}

function CreateForm({ onDone }: { onDone: () => void }) {
  const role = useQuery(sessionQuery).data?.role
  const [scope, setScope] = useState<'read' | 'run' | 'admin'>(hasRole(role, 'engineer') ? 'run' : 'read')
  const [days, setDays] = useState<number | null>(90)
  const create = useChange((name: string) => createToken({ body: { name, scope, days } }), ['tokens'])
  if (create.data)
    return (
      <Secret text={create.data.secret} copy="Copy the token" onDone={onDone}>
        The token {create.data.token.name}, shown only now. Send it as <code>Authorization: Bearer TOKEN</code>, or put it into{' '}
        <code>CLEARANCE_TOKEN</code> for the command line.
      </Secret>
    )
  return (
    <MakingForm
      hint="What it is for, such as nightly-ci. Runs that it launches show this name."
      sent={create}
      make="Create"
      making="Creating …"
      onMake={create.mutate}
      onDone={onDone}
    >
      <MayChoice title="Scope" value={scope} options={SCOPES.filter(({ least }) => hasRole(role, least))} onChange={setScope} />
      <label className={fields.lbl}>
        Expires
        <select className={fields.inp} value={days ?? ''} onChange={(event) => setDays(event.target.value ? Number(event.target.value) : null)}>
          {LIFETIMES.map((one) => (
            <option key={one.name} value={one.days ?? ''}>
              {one.days === null ? one.name : `in ${one.name}`}
            </option>
          ))}
        </select>
      </label>
    </MakingForm>
  )
}

function RevokeForm({ token, onDone }: { token: Token; onDone: () => void }) {
  const revoke = useChange(() => revokeToken({ path: { token: token.name } }), ['tokens'], onDone)
  return (
    <Form sent={revoke} send="Revoke" danger onSend={() => revoke.mutate()} leave="Keep it" onLeave={onDone}>
      <p className="sec">Programs that use it are refused from now on. This cannot be undone, and the name cannot be used again.</p>
    </Form>
  )
}
