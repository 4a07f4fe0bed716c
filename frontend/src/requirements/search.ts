// The state of the page of requirements in the address.
import { isStatus, type Status } from './status'

export interface RequirementsSearch {
  q?: string
  /** Only requirements with this status. */
  status?: Status
}

export function readRequirements({ q, status }: Record<string, unknown>): RequirementsSearch {
  return {
    ...(typeof q === 'string' && q ? { q: q.slice(0, 200) } : {}),
    ...(isStatus(status) ? { status } : {}),
  }
}
