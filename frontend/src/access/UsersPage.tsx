// Users with their roles, for administrators: inviting, changing, withdrawing access; the setting of sign-offs.
import { IconUserPlus } from '@tabler/icons-react'
import { useMutation, useQuery, useQueryClient } from '@tanstack/react-query'
import { useNavigate, useSearch } from '@tanstack/react-router'
import { useState } from 'react'
import { type Role, ROLES, settingsQuery, usersQuery } from '../api/access'
import { useChange } from '../api/change'
import { sessionQuery } from '../api/queries'
import { changeSettings, changeUser, renewInvitation, type User } from '../client'
import { count } from '../format/numbers'
import { moment, when } from '../format/time'
import { Failed, Loaded } from '../page/Trouble'
import { Button } from '../ui/Button'
import { Card } from '../ui/Card'
import { buttonColumn, type Column, Table, timeColumn } from '../ui/Table'
import { Form, Refused } from '../ui/Form'
import { Pick } from '../overlay/Menu'
import { Modal } from '../overlay/Modal'
import { AccessFrame } from './AccessFrame'
import { InvitationLink, InviteForm } from './Invite'
import { MayChoice } from './MakingForm'

export function UsersPage() {
  const { invite = false } = useSearch({ from: '/access/users' })
  const navigate = useNavigate({ from: '/access/users' })
  const ask = (open: boolean) => void navigate({ search: { invite: open || undefined }, replace: true })
  const users = useQuery(usersQuery)
  const [changing, setChanging] = useState<User | null>(null)
  return (
    <AccessFrame
      title="Users"
      actions={
        users.data && (
          <Button main icon={IconUserPlus} onClick={() => ask(true)}>Invite</Button>
        )
      }
    >
      <Loaded query={users} what="users">
        {(data) => (
          <>
            <Card title="Accounts" note="Names stay in the records: a user is disabled, never deleted" flush>
              <UsersList users={data} onChange={setChanging} />
            </Card>
            <SignOffs />
          </>
        )}
      </Loaded>
      <Modal opened={invite && users.data !== undefined} onClose={() => ask(false)} title="Invite a user">
        <InviteForm onDone={() => ask(false)} />
      </Modal>
      <Modal opened={changing !== null} onClose={() => setChanging(null)} title={changing?.name ?? ''}>
        {changing && <ChangeForm user={changing} onDone={() => setChanging(null)} />}
      </Modal>
    </AccessFrame>
  )
}

function UsersList({ users, onChange }: { users: readonly User[]; onChange: (user: User) => void }) {
  const self = useQuery(sessionQuery).data?.account
  const columns: Column<User>[] = [
    { head: 'Name', tone: 'm', cell: ({ name }) => [name, name === self && <span key="you" className="mut"> (you)</span>] },
    { head: 'Role', label: 'Role', cell: ({ role }) => role },
    { head: 'Access', label: 'Access', cell: (user) => <Access user={user} /> },
    { head: 'Browsers', num: true, label: 'Browsers', cell: ({ sessions }) => count(sessions) },
    timeColumn(
      'Invited',
      ({ created }) => created,
      ({ fixed, created, created_by }) => (fixed ? 'by the login link' : `${when(created)}, by ${created_by}`),
    ),
    buttonColumn('Change', (user) =>
      !user.fixed &&
      user.name !== self && (
        <Button small aria-label={`Change ${user.name}`} onClick={() => onChange(user)}>Change …</Button>
      ),
    ),
  ]
  return <Table stack rows={users} by={({ name }) => name} columns={columns} />
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
  const [role, setRole] = useState<Role>(user.role)
  // Refused with 412 if another administrator has changed the user since they were read.
  const change = useChange(
    (body: { role?: Role; disabled?: boolean }) => changeUser({ path: { user: user.name }, body, headers: { 'If-Match': user.etag } }),
    ['users'],
    onDone,
  )
  const renew = useChange(() => renewInvitation({ path: { user: user.name } }), ['users'])
  if (renew.data) return <InvitationLink invitation={renew.data} onDone={onDone} />
  const disabled = user.state === 'disabled'
  return (
    <Form
      sent={{ isPending: change.isPending, error: change.error ?? renew.error }}
      send={!user.provided && 'Change the role'}
      off={role === user.role}
      onSend={() => change.mutate({ role })}
      more={
        <>
          {!disabled && !user.provided && (
            <Button disabled={renew.isPending} onClick={() => renew.mutate()}>New link</Button>
          )}
          <Button danger={!disabled} disabled={change.isPending} onClick={() => change.mutate({ disabled: !disabled })}>
            {disabled ? 'Grant access again' : 'Withdraw access'}
          </Button>
        </>
      }
    >
      {user.provided ? (
        <p>The role {user.role} follows this user's groups at the sign-in provider.</p>
      ) : (
        <MayChoice title="Role" value={role} options={ROLES} onChange={setRole} />
      )}
      <p className="small mut">A change applies at once, to open browsers and API tokens too.</p>
    </Form>
  )
}

function SignOffs() {
  const cache = useQueryClient()
  const { data, error, refetch } = useQuery(settingsQuery)
  const change = useMutation({
    mutationFn: (own: boolean) => changeSettings({ body: { own_sign_offs: own } }),
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
      <Refused error={change.error} />
    </Card>
  )
}
