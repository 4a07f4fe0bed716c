// What whoever is signed in may not do, by role and by owner, as the sentence of a disabled button. The service decides in
// any case (`backend/access`): what is not known yet is offered.
import { useQuery } from '@tanstack/react-query'
import type { SessionInfo, Token } from '../client'
import { hasRole, type Role, tokensQuery } from './access'
import { sessionQuery } from './queries'

/** A run, sweep, draft or sign-off, and the user or API token that it belongs to. */
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

/** Those that the account owns by a token, or not at all. */
const notByName = (session: SessionInfo | undefined, things: readonly Owned[]): Owned[] =>
  session === undefined || session.role === 'admin' ? [] : things.filter(({ owner }) => owner !== session.account)

/**
 * Why role or owner do not permit changing all of `things`: only their owner, itself or by one of its tokens, and
 * administrators may; undefined if they do, or if that is not known yet.
 */
export function barredFromOwn(
  session: SessionInfo | undefined,
  tokens: readonly Token[] | undefined,
  least: Role,
  things: readonly Owned[],
): string | undefined {
  const low = barredFrom(session?.role, least)
  if (low !== undefined || session === undefined || tokens === undefined) return low
  const mine = new Set(tokens.filter(({ owner }) => owner === session.account).map(({ name }) => name))
  const other = notByName(session, things).find(({ owner }) => !mine.has(owner))
  if (other === undefined) return undefined
  const { id, owner } = other
  return `${id} belongs to ${owner || 'another user'}, and you are ${session.account}: only its owner and an administrator may change it.`
}

export function useBarredFromOwn(least: Role, ...things: readonly Owned[]): string | undefined {
  const session = useQuery(sessionQuery).data
  const byToken = hasRole(session?.role, least) && notByName(session, things).length > 0
  const tokens = useQuery({ ...tokensQuery, enabled: byToken, staleTime: 60_000 }).data
  return barredFromOwn(session, byToken ? tokens : [], least, things)
}
