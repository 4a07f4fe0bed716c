// The browsers that are signed in: your own, for administrators all; and changing your password.
import { clsx } from 'clsx'
import { IconLock } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { useState } from 'react'
import { sessionsQuery } from '../api/access'
import { useChange } from '../api/change'
import { sessionQuery } from '../api/queries'
import { type BrowserSession, changePassword, revokeSession } from '../client'
import { moment, when } from '../format/time'
import { Loaded } from '../page/Trouble'
import { Button } from '../ui/Button'
import { Card } from '../ui/Card'
import { buttonColumn, type Column, Table, timeColumn } from '../ui/Table'
import { Field, Form, Refused } from '../ui/Form'
import { Modal } from '../overlay/Modal'
import { AccessFrame } from './AccessFrame'
import { browserOf } from './browser'
import styles from './access.module.css'
import { fields } from '../ui/styles'

export function SessionsPage() {
  const sessions = useQuery(sessionsQuery)
  const self = useQuery(sessionQuery).data
  const [changing, setChanging] = useState(false)
  const word = self?.has_password ? 'Change password' : 'Set a password'
  return (
    <AccessFrame
      title="Sessions"
      actions={
        self &&
        self.via !== 'token' && self.via !== 'provider' && (
          <Button icon={IconLock} onClick={() => setChanging(true)}>{word}</Button>
        )
      }
    >
      <Loaded query={sessions} what="sessions">
        {(data) => (
          <Card title="Browsers that are signed in" note="A session ends two weeks after signing in, by single sign-on after 12 hours" flush={data.length > 0}>
            {data.length === 0 ? <p className="sec">No browser is signed in.</p> : <BrowsersList sessions={data} />}
          </Card>
        )}
      </Loaded>
      <Modal opened={changing} onClose={() => setChanging(false)} title={word}>
        {changing && <PasswordForm has={self?.has_password ?? false} user={self?.account ?? ''} onDone={() => setChanging(false)} />}
      </Modal>
    </AccessFrame>
  )
}

function BrowsersList({ sessions }: { sessions: readonly BrowserSession[] }) {
  const revoke = useChange((session: string) => revokeSession({ path: { session } }), ['sessions'])
  const columns: Column<BrowserSession>[] = [
    { head: 'User', tone: clsx('m', styles.who), cell: ({ user }) => user },
    { head: 'Browser', tone: 'nw', label: 'Browser', tip: ({ agent }) => agent, cell: ({ agent }) => browserOf(agent) },
    { head: 'Address', tone: 'sec', label: 'Address', cell: ({ address }) => address || 'not recorded' },
    timeColumn(
      'Signed in',
      ({ created }) => created,
      ({ created, via }) => `${when(created)}, by ${{ link: 'login link', password: 'password', provider: 'single sign-on' }[via]}`,
    ),
    { head: 'Last used', tone: 'sec nw', label: 'Last used', cell: ({ last_used: last }) => (last === null ? 'not since the service started' : when(last)) },
    { head: 'Ends', tone: 'sec nw', label: 'Ends', cell: ({ expires }) => moment(expires) },
    buttonColumn('Sign out', ({ id, current, user, agent }) =>
      current ? (
        <span className="mut">this browser</span>
      ) : (
        <Button small disabled={revoke.isPending} aria-label={`Sign out ${user}, ${browserOf(agent)}`} onClick={() => revoke.mutate(id)}>
          Sign out
        </Button>
      ),
    ),
  ]
  return (
    <>
      <Refused error={revoke.error} />
      <Table stack rows={sessions} by={({ id }) => id} columns={columns} />
    </>
  )
}

function PasswordForm({ has, user, onDone }: { has: boolean; user: string; onDone: () => void }) {
  const [current, setCurrent] = useState('')
  const [next, setNext] = useState('')
  const [again, setAgain] = useState('')
  const change = useChange(() => changePassword({ body: { current: current || null, new: next } }), ['session', 'sessions'], onDone)
  const differ = again !== '' && again !== next
  return (
    <Form sent={change} send={has ? 'Change' : 'Set'} off={!next || again !== next} onSend={() => change.mutate()} onLeave={onDone}>
      <p className="sec">At least 12 characters; several words make a good one. All other browsers of {user} are signed out.</p>
      <input type="hidden" autoComplete="username" value={user} readOnly />
      {has && <Field label="Current password" type="password" autoComplete="current-password" required value={current} onChange={setCurrent} />}
      <Field label="New password" type="password" autoComplete="new-password" required value={next} onChange={setNext} />
      <Field label="The same again" type="password" autoComplete="new-password" required value={again} onChange={setAgain} />
      {differ && <p className={fields.ferr}>The two new passwords differ.</p>}
    </Form>
  )
}
