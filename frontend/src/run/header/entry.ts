// Texts for entries of the audit trail.
import type { HistoryEntry } from '../../client'

const text = (value: unknown): string => (typeof value === 'string' ? value : '')

type Detail = HistoryEntry['detail']

const TEXTS: Readonly<Record<string, (detail: Detail) => string>> = {
  'run.submitted': () => 'Submitted',
  'run.cancelled': ({ state }) => (state === 'cancelled' || state === 'cancelling' ? 'Cancelled' : 'Requested cancellation after its end'),
  'run.retried': ({ discarded }) =>
    discarded ? 'Tried it again, without its evaluations, none of which had a value' : 'Tried it again, with its stored evaluations',
  'run.restarted': () => 'Began it again, without its evaluations',
  'run.continued': ({ continues }) => `Continued ${text(continues)} as this run`,
  'run.edited': editOf,
  'run.removed': ({ reason }) => `Removed it from the lists: ${text(reason)}`,
  'run.restored': () => 'Restored it',
  'run.purged': ({ results_digest: digest }) => `Permanently deleted its results, sha256 ${text(digest).slice(0, 16)}`,
  'signoff.created': ({ name, role }) => `Signed off as ${[text(name), text(role)].filter(Boolean).join(', ')}`,
  'signoff.withdrawn': ({ reason }) => (reason ? `Withdrew a sign-off: ${text(reason)}` : 'Withdrew a sign-off'),
  'signoff.bound': () => 'An update stored the same results in another form; a sign-off was bound to it',
}

/** One entry of the audit trail as a sentence without its subject. */
export const statementOf = ({ action, detail }: HistoryEntry): string => TEXTS[action]?.(detail) ?? action

function editOf(detail: Detail): string {
  const parts: string[] = []
  if ('name' in detail) parts.push(`named it “${text(detail.name)}”`)
  if (Array.isArray(detail.tags)) parts.push(detail.tags.length > 0 ? `tagged it ${detail.tags.join(', ')}` : 'removed its tags')
  if ('notes' in detail) parts.push('wrote its notes')
  if ('pinned' in detail) parts.push(detail.pinned ? 'pinned it' : 'unpinned it')
  const sentence = parts.join('; ') || 'changed it'
  return sentence.charAt(0).toUpperCase() + sentence.slice(1)
}
