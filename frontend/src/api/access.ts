// The roles, and what the pages about users, tokens and sessions read.
import { queryOptions } from '@tanstack/react-query'
import * as sdk from '../client'

export type Role = sdk.SessionInfo['role']

/** From the least to the most; each includes those before it. */
export const ROLES: readonly { value: Role; may: string }[] = [
  { value: 'viewer', may: 'reads everything' },
  { value: 'engineer', may: 'also launches, cancels and edits their own' },
  { value: 'reviewer', may: 'also signs off and reads the audit trail' },
  { value: 'admin', may: 'also manages users, tokens, settings and removal' },
]

export const hasRole = (role: Role | undefined, least: Role): boolean =>
  role !== undefined && ROLES.findIndex(({ value }) => value === role) >= ROLES.findIndex(({ value }) => value === least)

export const usersQuery = queryOptions({ queryKey: ['users'], queryFn: () => sdk.listUsers(), staleTime: 0 })
export const settingsQuery = queryOptions({ queryKey: ['settings'], queryFn: () => sdk.getSettings() })
export const tokensQuery = queryOptions({ queryKey: ['tokens'], queryFn: () => sdk.listTokens(), staleTime: 0 })
export const sessionsQuery = queryOptions({ queryKey: ['sessions'], queryFn: () => sdk.listSessions(), staleTime: 0 })
