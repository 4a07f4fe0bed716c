// What the addresses of the pages about access hold.

export interface UsersSearch {
  /** Whether the form of an invitation is open. */
  invite?: boolean
}

export const readUsers = (search: Record<string, unknown>): UsersSearch => ({ invite: search.invite === true || undefined })

export interface AuditSearch {
  actor?: string
  action?: string
}

const word = (value: unknown, longest: number): string | undefined => {
  const text = typeof value === 'number' ? String(value) : value
  return typeof text === 'string' && text && text.length <= longest ? text : undefined
}

export const readAudit = (search: Record<string, unknown>): AuditSearch => ({
  actor: word(search.actor, 64),
  action: word(search.action, 40),
})
