// The requests of the pages about users, tokens, sessions and the audit trail.
import { queryOptions } from '@tanstack/react-query'
import type { AccessSettings, SessionInfo, TokenRequest, User, UserChange, UserInvite } from '../client'
import * as sdk from '../client'
import { answer } from './calls'

export type Role = SessionInfo['role']

/** From the least to the most; each includes those before it. */
export const ROLES: readonly { value: Role; may: string }[] = [
  { value: 'viewer', may: 'reads everything' },
  { value: 'engineer', may: 'also launches, cancels and edits their own' },
  { value: 'reviewer', may: 'also signs off and reads the audit trail' },
  { value: 'admin', may: 'also manages users, tokens, settings and removal' },
]

export const hasRole = (role: Role | undefined, least: Role): boolean =>
  role !== undefined && ROLES.findIndex(({ value }) => value === role) >= ROLES.findIndex(({ value }) => value === least)

export const usersQuery = queryOptions({ queryKey: ['users'], queryFn: () => answer(sdk.listUsers()), staleTime: 0 })
export const settingsQuery = queryOptions({ queryKey: ['settings'], queryFn: () => answer(sdk.getSettings()) })
export const tokensQuery = queryOptions({ queryKey: ['tokens'], queryFn: () => answer(sdk.listTokens()), staleTime: 0 })
export const sessionsQuery = queryOptions({ queryKey: ['sessions'], queryFn: () => answer(sdk.listSessions()), staleTime: 0 })

export const inviteUser = (body: UserInvite) => answer(sdk.inviteUser({ body }))
export const renewInvitation = (user: string) => answer(sdk.renewInvitation({ path: { user } }))
/** Refused with 412 if another administrator has changed the user since they were read. */
export const changeUser = (user: User, body: UserChange) =>
  answer(sdk.changeUser({ path: { user: user.name }, body, headers: { 'If-Match': user.etag } }))
export const changeSettings = (body: AccessSettings) => answer(sdk.changeSettings({ body }))
export const createToken = (body: TokenRequest) => answer(sdk.createToken({ body }))
export const revokeToken = (token: string) => answer(sdk.revokeToken({ path: { token } }))
export const revokeSession = (session: string) => answer(sdk.revokeSession({ path: { session } }))
export const changePassword = (current: string, next: string) =>
  answer(sdk.changePassword({ body: { current: current || null, new: next } }))
export const listAudit = (actor: string, action: string, cursor: string | null) =>
  answer(sdk.listAudit({ query: { actor, action, ...(cursor ? { cursor } : {}) } }))
