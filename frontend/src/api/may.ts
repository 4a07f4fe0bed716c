// What the role of whoever is signed in does not permit, as the sentence of a disabled button.
import { useQuery } from '@tanstack/react-query'
import { hasRole, type Role } from './access'
import { sessionQuery } from './queries'

/** Why a role does not permit it; undefined if it does, or is not known yet: the service decides in any case. */
export function barredFrom(role: Role | undefined, least: Role): string | undefined {
  if (role === undefined || hasRole(role, least)) return undefined
  return `This needs the role ${least}; yours is ${role}.`
}

export const useBarred = (least: Role): string | undefined => barredFrom(useQuery(sessionQuery).data?.role, least)
