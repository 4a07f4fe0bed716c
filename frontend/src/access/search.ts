// What the addresses of the pages about access hold.
import { flag, text } from '../format/query'

export interface UsersSearch {
  /** Whether the form of an invitation is open. */
  invite?: boolean
}

export const readUsers = (search: Record<string, unknown>): UsersSearch => ({ invite: flag(search.invite) })

export interface AuditSearch {
  actor?: string
  action?: string
}

const word = (value: unknown, longest: number): string | undefined => {
  const found = text(value)
  return found && found.length <= longest ? found : undefined
}

export const readAudit = (search: Record<string, unknown>): AuditSearch => ({
  actor: word(search.actor, 64),
  action: word(search.action, 40),
})
