// What whoever is signed in may not do, by role and by owner, as the sentence of a disabled button. The service decides in
// any case (`backend/access`): what is not known yet is offered.
import { useQuery } from '@tanstack/react-query'
import type { SessionInfo } from '../client'
import { hasRole, type Role } from './access'
import { sessionQuery } from './queries'

/** A run, sweep, draft or sign-off, and the user that it belongs to. */
export interface Owned {
  id: string
  owner: string
}

/** Why a role does not permit it; undefined if it does, or is not known yet. */
export function barredFrom(role: Role | undefined, least: Role): string | undefined {
  if (role === undefined || hasRole(role, least)) return undefined
  return `This needs the role ${least}; yours is ${role}.`
}

export const useBarred = (least: Role): string | undefined => barredFrom(useQuery(sessionQuery).data?.role, least)

/**
 * Why role or owner do not permit changing all of `things`: only their owner and administrators may; undefined if they
 * do, or if that is not known yet.
 */
export function barredFromOwn(session: SessionInfo | undefined, least: Role, things: readonly Owned[]): string | undefined {
  const low = barredFrom(session?.role, least)
  if (low !== undefined || session === undefined || session.role === 'admin') return low
  const other = things.find(({ owner }) => owner !== session.account)
  if (other === undefined) return undefined
  const { id, owner } = other
  return `${id} belongs to ${owner || 'another user'}, and you are ${session.account}: only its owner and an administrator may change it.`
}

export const useBarredFromOwn = (least: Role, ...things: readonly Owned[]): string | undefined =>
  barredFromOwn(useQuery(sessionQuery).data, least, things)
