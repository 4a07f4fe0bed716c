// Texts for entries of the audit trail.
import type { HistoryEntry } from '../../client'

const text = (value: unknown): string => (typeof value === 'string' ? value : '')

/** One entry of the audit trail as a sentence without its subject. */
export function statementOf({ action, detail }: HistoryEntry): string {
  switch (action) {
    case 'run.submitted':
      return 'Submitted'
    case 'run.cancelled':
      return detail.state === 'cancelled' || detail.state === 'cancelling' ? 'Cancelled' : 'Requested cancellation after its end'
    case 'run.retried':
      return 'Tried it again, with its stored evaluations'
    case 'run.restarted':
      return 'Began it again, without its evaluations'
    case 'run.continued':
      return `Continued ${text(detail.continues)} as this run`
    case 'run.edited':
      return editOf(detail)
    case 'run.removed':
      return `Removed it from the lists: ${text(detail.reason)}`
    case 'run.restored':
      return 'Restored it'
    case 'run.purged':
      return `Permanently deleted its results, sha256 ${text(detail.results_digest).slice(0, 16)}`
    case 'signoff.created':
      return `Signed off as ${[text(detail.name), text(detail.role)].filter(Boolean).join(', ')}`
    case 'signoff.withdrawn':
      return detail.reason ? `Withdrew a sign-off: ${text(detail.reason)}` : 'Withdrew a sign-off'
    case 'signoff.bound':
      return 'An update stored the same results in another form; a sign-off was bound to it'
    default:
      return action
  }
}

function editOf(detail: HistoryEntry['detail']): string {
  const parts: string[] = []
  if ('name' in detail) parts.push(`named it “${text(detail.name)}”`)
  if (Array.isArray(detail.tags)) parts.push(detail.tags.length > 0 ? `tagged it ${detail.tags.join(', ')}` : 'removed its tags')
  if ('notes' in detail) parts.push('wrote its notes')
  if ('pinned' in detail) parts.push(detail.pinned ? 'pinned it' : 'unpinned it')
  const sentence = parts.join('; ') || 'changed it'
  return sentence.charAt(0).toUpperCase() + sentence.slice(1)
}
