// Users with their roles, for administrators: inviting, changing, withdrawing access; the setting of sign-offs.
import { clsx } from 'clsx'
import { IconUserPlus } from '@tabler/icons-react'
import { useMutation, useQuery, useQueryClient } from '@tanstack/react-query'
import { useNavigate, useSearch } from '@tanstack/react-router'
import { useState } from 'react'
import { changeSettings, changeUser, renewInvitation, type Role, settingsQuery, usersQuery } from '../api/access'
import { sessionQuery } from '../api/queries'
import type { User } from '../client'
import { count } from '../format/numbers'
import { moment, when } from '../format/time'
import { Failed, Loading, Trouble } from '../page/Trouble'
import { Card } from '../ui/Card'
import { Pick } from '../ui/Menu'
import { Modal } from '../ui/Modal'
import { AccessFrame } from './AccessFrame'
import { InvitationLink, InviteForm, RoleChoice } from './Invite'
import buttons from '../ui/buttons.module.css'
import fields from '../ui/fields.module.css'
import layout from '../ui/layout.module.css'
import tables from '../ui/tables.module.css'

export function UsersPage() {
  const { invite = false } = useSearch({ from: '/access/users' })
  const navigate = useNavigate({ from: '/access/users' })
  const ask = (open: boolean) => void navigate({ search: { invite: open || undefined }, replace: true })
  const { data, error, isError, failureReason, refetch } = useQuery(usersQuery)
  const [changing, setChanging] = useState<User | null>(null)
  return (
    <AccessFrame
      title="Users"
      actions={
        data && (
          <button type="button" className={clsx(buttons.btn, buttons.p)} onClick={() => ask(true)}>
            <IconUserPlus className="i s" aria-hidden /> Invite
          </button>
        )
      }
    >
      {isError && !data ? (
        <Trouble error={error} retry={() => void refetch()} below />
      ) : !data ? (
        <Loading what="users" failed={failureReason} />
      ) : (
        <>
          <Card title="Accounts" note="Names stay in the records: a user is disabled, never deleted" flush>
            <Table users={data} onChange={setChanging} />
          </Card>
          <SignOffs />
        </>
      )}
      <Modal opened={invite && data !== undefined} onClose={() => ask(false)} title="Invite a user" centered lockScroll={false}>
        <InviteForm onDone={() => ask(false)} />
      </Modal>
      <Modal opened={changing !== null} onClose={() => setChanging(null)} title={changing?.name ?? ''} centered lockScroll={false}>
        {changing && <ChangeForm user={changing} onDone={() => setChanging(null)} />}
      </Modal>
    </AccessFrame>
  )
}

function Table({ users, onChange }: { users: readonly User[]; onChange: (user: User) => void }) {
  const self = useQuery(sessionQuery).data?.account
  return (
    <table className={clsx(tables.table, tables.stack)}>
      <thead>
        <tr>
          <th>Name</th>
          <th>Role</th>
          <th>Access</th>
          <th className="num">Browsers</th>
          <th>Invited</th>
          <th>
            <span className="sr">Change</span>
          </th>
        </tr>
      </thead>
      <tbody>
        {users.map((user) => (
          <tr key={user.name}>
            <td className="m">
              {user.name}
              {user.name === self && <span className="mut"> (you)</span>}
            </td>
            <td data-label="Role">{user.role}</td>
            <td data-label="Access">
              <Access user={user} />
            </td>
            <td className="num" data-label="Browsers">{count(user.sessions)}</td>
            <td className="sec nw" data-label="Invited" title={moment(user.created)}>
              {user.fixed ? 'by the login link' : `${when(user.created)}, by ${user.created_by}`}
            </td>
            <td className="num">
              {!user.fixed && user.name !== self && (
                <button type="button" className={clsx(buttons.btn, buttons.s)} aria-label={`Change ${user.name}`} onClick={() => onChange(user)}>
                  Change …
                </button>
              )}
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  )
}

function Access({ user }: { user: User }) {
  const link = user.invited_until !== null && <span className="mut">, link valid until {moment(user.invited_until)}</span>
  if (user.state === 'disabled') return <span className="bad-t">withdrawn</span>
  if (user.state === 'invited') return <span className="sec nw">{link ? <>invited{link}</> : 'invited, the link has expired'}</span>
  return (
    <span className="sec">
      {user.provided ? 'single sign-on' : user.has_password ? 'password' : 'login link'}
      {link}
    </span>
  )
}

function ChangeForm({ user, onDone }: { user: User; onDone: () => void }) {
  const cache = useQueryClient()
  const [role, setRole] = useState<Role>(user.role)
  const refresh = () => cache.invalidateQueries({ queryKey: ['users'] })
  const change = useMutation({
    mutationFn: (given: { role?: Role; disabled?: boolean }) => changeUser(user, given),
    onSuccess: () => refresh().then(onDone),
    // Refused because another administrator has changed the user: show the current state.
    onError: refresh,
  })
  const renew = useMutation({ mutationFn: () => renewInvitation(user.name), onSuccess: refresh })
  if (renew.data) return <InvitationLink invitation={renew.data} onDone={onDone} />
  const disabled = user.state === 'disabled'
  const error = change.error ?? renew.error
  return (
    <form
      className={fields.panel}
      onSubmit={(event) => {
        event.preventDefault()
        change.mutate({ role })
      }}
    >
      {user.provided ? (
        <p>The role {user.role} follows this user's groups at the sign-in provider.</p>
      ) : (
        <RoleChoice value={role} onChange={setRole} />
      )}
      <p className="small mut">A change applies at once, to open browsers and API tokens too.</p>
      {error && (
        <p className={fields.ferr} role="alert">
          {error.message}
        </p>
      )}
      <div className={layout.acts} style={{ justifyContent: 'flex-end' }}>
        {!disabled && !user.provided && (
          <button type="button" className={buttons.btn} disabled={renew.isPending} onClick={() => renew.mutate()}>
            New link
          </button>
        )}
        <button type="button" className={clsx(buttons.btn, !disabled && buttons.danger)} disabled={change.isPending} onClick={() => change.mutate({ disabled: !disabled })}>
          {disabled ? 'Grant access again' : 'Withdraw access'}
        </button>
        {!user.provided && (
          <button type="submit" className={clsx(buttons.btn, buttons.p)} disabled={change.isPending || role === user.role}>
            Change the role
          </button>
        )}
      </div>
    </form>
  )
}

function SignOffs() {
  const cache = useQueryClient()
  const { data, error, refetch } = useQuery(settingsQuery)
  const change = useMutation({
    mutationFn: (own: boolean) => changeSettings({ own_sign_offs: own }),
    onSuccess: (stored) => cache.setQueryData(settingsQuery.queryKey, stored),
  })
  return (
    <Card title="Sign-offs" note="Independent review">
      {!data && !error && <p className="mut">Loading the setting …</p>}
      {!data && error && <Failed error={error} retry={() => void refetch()} />}
      {data && (
        <Pick on={data.own_sign_offs} onChange={(on) => change.mutate(on)}>
          Users may sign off runs that they launched; each such sign-off, and the report, says so
        </Pick>
      )}
      {change.isError && (
        <p className={fields.ferr} role="alert">
          {change.error.message}
        </p>
      )}
    </Card>
  )
}
