// Inviting a user: name and role, then the link, which is shown only once.
import { Link } from '@tanstack/react-router'
import { useState } from 'react'
import { useChange } from '../api/change'
import { type Role, ROLES } from '../api/access'
import { type Invitation, inviteUser } from '../client'
import { moment } from '../format/time'
import { isLocal } from './hosts'
import { MakingForm, MayChoice } from './MakingForm'
import { Secret } from './Secret'
import { ROOT } from '../format/root'

export function InviteForm({ onDone }: { onDone: () => void }) {
  const [role, setRole] = useState<Role>('engineer')
  const invite = useChange((name: string) => inviteUser({ body: { name, role } }), ['users'])
  if (invite.data) return <InvitationLink invitation={invite.data} onDone={onDone} />
  return (
    <MakingForm
      hint="Lower-case letters, digits and . _ + @ -, for example an e-mail address. It stays in all records."
      sent={invite}
      make="Make the link"
      making="Making the link …"
      onMake={invite.mutate}
      onDone={onDone}
    >
      <MayChoice title="Role" value={role} options={ROLES} onChange={setRole} />
    </MakingForm>
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
