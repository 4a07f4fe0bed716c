// The browsers that are signed in: your own, for administrators all; and changing your password.
import { clsx } from 'clsx'
import { IconLock } from '@tabler/icons-react'
import { useMutation, useQuery, useQueryClient } from '@tanstack/react-query'
import { useState } from 'react'
import { changePassword, revokeSession, sessionsQuery } from '../api/access'
import { sessionQuery } from '../api/queries'
import type { BrowserSession } from '../client'
import { moment, when } from '../format/time'
import { Loading, Trouble } from '../page/Trouble'
import { Card } from '../ui/Card'
import { Modal } from '../ui/Modal'
import { AccessFrame } from './AccessFrame'
import { browserOf } from './browser'
import styles from './access.module.css'
import buttons from '../ui/buttons.module.css'
import fields from '../ui/fields.module.css'
import layout from '../ui/layout.module.css'
import tables from '../ui/tables.module.css'

export function SessionsPage() {
  const { data, error, isError, failureReason, refetch } = useQuery(sessionsQuery)
  const self = useQuery(sessionQuery).data
  const [changing, setChanging] = useState(false)
  const word = self?.has_password ? 'Change password' : 'Set a password'
  return (
    <AccessFrame
      title="Sessions"
      actions={
        self &&
        self.via !== 'token' && self.via !== 'provider' && (
          <button type="button" className={buttons.btn} onClick={() => setChanging(true)}>
            <IconLock className="i s" aria-hidden /> {word}
          </button>
        )
      }
    >
      {isError && !data ? (
        <Trouble error={error} retry={() => void refetch()} below />
      ) : !data ? (
        <Loading what="sessions" failed={failureReason} />
      ) : (
        <Card title="Browsers that are signed in" note="Two weeks after signing in, a session ends" flush={data.length > 0}>
          {data.length === 0 ? <p className="sec">No browser is signed in.</p> : <Table sessions={data} />}
        </Card>
      )}
      <Modal opened={changing} onClose={() => setChanging(false)} title={word} centered lockScroll={false}>
        {changing && <PasswordForm has={self?.has_password ?? false} user={self?.account ?? ''} onDone={() => setChanging(false)} />}
      </Modal>
    </AccessFrame>
  )
}

function Table({ sessions }: { sessions: readonly BrowserSession[] }) {
  const cache = useQueryClient()
  const revoke = useMutation({
    mutationFn: revokeSession,
    onSettled: () => cache.invalidateQueries({ queryKey: ['sessions'] }),
  })
  return (
    <>
      {revoke.isError && (
        <p className={fields.ferr} role="alert">
          {revoke.error.message}
        </p>
      )}
      <table className={clsx(tables.table, tables.stack)}>
        <thead>
          <tr>
            <th>User</th>
            <th>Browser</th>
            <th>Address</th>
            <th>Signed in</th>
            <th>Last used</th>
            <th>Ends</th>
            <th>
              <span className="sr">Sign out</span>
            </th>
          </tr>
        </thead>
        <tbody>
          {sessions.map((session) => (
            <tr key={session.id}>
              <td className={`m ${styles.who ?? ''}`}>{session.user}</td>
              <td className="nw" data-label="Browser" title={session.agent}>{browserOf(session.agent)}</td>
              <td className="sec" data-label="Address">{session.address || 'not recorded'}</td>
              <td className="sec nw" data-label="Signed in" title={moment(session.created)}>
                {when(session.created)}, by {{ link: 'login link', password: 'password', provider: 'single sign-on' }[session.via]}
              </td>
              <td className="sec nw" data-label="Last used">{session.last_used === null ? 'not since the service started' : when(session.last_used)}</td>
              <td className="sec nw" data-label="Ends">{moment(session.expires)}</td>
              <td className="num">
                {session.current ? (
                  <span className="mut">this browser</span>
                ) : (
                  <button
                    type="button"
                    className={clsx(buttons.btn, buttons.s)}
                    disabled={revoke.isPending}
                    aria-label={`Sign out ${session.user}, ${browserOf(session.agent)}`}
                    onClick={() => revoke.mutate(session.id)}
                  >
                    Sign out
                  </button>
                )}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </>
  )
}

function PasswordForm({ has, user, onDone }: { has: boolean; user: string; onDone: () => void }) {
  const cache = useQueryClient()
  const [current, setCurrent] = useState('')
  const [next, setNext] = useState('')
  const [again, setAgain] = useState('')
  const change = useMutation({
    mutationFn: () => changePassword(current, next),
    onSuccess: async () => {
      await Promise.all(['session', 'sessions'].map((key) => cache.invalidateQueries({ queryKey: [key] })))
      onDone()
    },
  })
  const differ = again !== '' && again !== next
  return (
    <form
      className={fields.panel}
      onSubmit={(event) => {
        event.preventDefault()
        change.mutate()
      }}
    >
      <p className="sec">At least 12 characters; several words make a good one. All other browsers of {user} are signed out.</p>
      <input type="hidden" autoComplete="username" value={user} readOnly />
      {has && <Password label="Current password" kind="current-password" value={current} onChange={setCurrent} />}
      <Password label="New password" kind="new-password" value={next} onChange={setNext} />
      <Password label="The same again" kind="new-password" value={again} onChange={setAgain} />
      {differ && <p className={fields.ferr}>The two new passwords differ.</p>}
      {change.isError && (
        <p className={fields.ferr} role="alert">
          {change.error.message}
        </p>
      )}
      <div className={layout.acts} style={{ justifyContent: 'flex-end' }}>
        <button type="button" className={buttons.btn} onClick={onDone}>
          Not now
        </button>
        <button type="submit" className={clsx(buttons.btn, buttons.p)} disabled={change.isPending || !next || again !== next}>
          {has ? 'Change' : 'Set'}
        </button>
      </div>
    </form>
  )
}

interface PasswordProps {
  label: string
  kind: string
  value: string
  onChange: (text: string) => void
}

function Password({ label, kind, value, onChange }: PasswordProps) {
  return (
    <label className={fields.lbl}>
      {label}
      <input className={fields.inp} type="password" autoComplete={kind} required value={value} onChange={(event) => onChange(event.target.value)} />
    </label>
  )
}
