// Inviting a user: name and role, then the link, which is shown only once.
import { clsx } from 'clsx'
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import { useState } from 'react'
import { inviteUser, type Role, ROLES } from '../api/access'
import type { Invitation } from '../client'
import { moment } from '../format/time'
import { isLocal } from './hosts'
import { Secret } from './Secret'
import { ROOT } from '../format/root'
import styles from './access.module.css'
import buttons from '../ui/buttons.module.css'
import fields from '../ui/fields.module.css'
import layout from '../ui/layout.module.css'

export function InviteForm({ onDone }: { onDone: () => void }) {
  const cache = useQueryClient()
  const [name, setName] = useState('')
  const [role, setRole] = useState<Role>('engineer')
  const invite = useMutation({
    mutationFn: () => inviteUser({ name: name.trim(), role }),
    onSuccess: () => cache.invalidateQueries({ queryKey: ['users'] }),
  })
  if (invite.data) return <InvitationLink invitation={invite.data} onDone={onDone} />
  return (
    <form
      className={fields.panel}
      onSubmit={(event) => {
        event.preventDefault()
        invite.mutate()
      }}
    >
      <label className={fields.lbl}>
        Name
        <input
          className={fields.inp}
          value={name}
          maxLength={64}
          required
          autoCapitalize="none"
          autoComplete="off"
          spellCheck={false}
          data-autofocus
          onChange={(event) => setName(event.target.value)}
        />
        <span className="small mut">Lower-case letters, digits and . _ + @ -, for example an e-mail address. It stays in all records.</span>
      </label>
      <RoleChoice value={role} onChange={setRole} />
      {invite.isError && (
        <p className={fields.ferr} role="alert">
          {invite.error.message}
        </p>
      )}
      <div className={layout.acts} style={{ justifyContent: 'flex-end' }}>
        <button type="button" className={buttons.btn} onClick={onDone}>
          Not now
        </button>
        <button type="submit" className={clsx(buttons.btn, buttons.p)} disabled={invite.isPending || !name.trim()}>
          Make the link
        </button>
      </div>
    </form>
  )
}

export function InvitationLink({ invitation, onDone }: { invitation: Invitation; onDone: () => void }) {
  const link = (invitation.address ?? window.location.origin + ROOT) + invitation.path
  return (
    <Secret text={link} copy="Copy the link" onDone={onDone}>
      Send this link to {invitation.user}. It is shown only now, can be used once, and is valid until {moment(invitation.expires)}. Opening it
      asks for a password.
      {isLocal(new URL(link).hostname) && (
        <>
          {' '}
          <b>This address works only on the machine of the service.</b> For other machines see{' '}
          <Link to="/help/guides/$name" params={{ name: 'access' }}>
            the guide
          </Link>
          .
        </>
      )}
    </Secret>
  )
}

export function RoleChoice({ value, onChange }: { value: Role; onChange: (role: Role) => void }) {
  return (
    <fieldset className={styles.choices}>
      <legend className={fields.lbl}>Role</legend>
      {ROLES.map(({ role, may }) => (
        <label key={role} className={fields.pickrow}>
          <input type="radio" name="role" checked={role === value} onChange={() => onChange(role)} />
          <span>
            <b>{role}</b> <span className="sec">{may}</span>
          </span>
        </label>
      ))}
    </fieldset>
  )
}
