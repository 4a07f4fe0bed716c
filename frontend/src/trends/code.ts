// The code of runs in words: what is not known of it, and what differs.
import type { RelatedRun, TrendRun } from '../client'

/** Why a run has no digest of its code. */
export const unreadOf = (identity: { unidentified: readonly string[] } | null | undefined): string =>
  identity && identity.unidentified.some((name) => name !== 'engine') ? `not identified: ${identity.unidentified.join(', ')}` : 'code not stored'

/** The names of what differs, the first few. */
export const namesOf = (names: readonly string[], most = 3): string =>
  names.length > most ? `${names.slice(0, most).join(', ')} and ${names.length - most} more` : names.join(', ')

/** In what another run of the same campaign differs. */
export function differenceOf({ differs, code_changes: names, code_known: known, seed }: Pick<RelatedRun, 'differs' | 'code_changes' | 'code_known' | 'seed'>): string {
  const parts = differs.map((what) => (what === 'seed' ? `seed ${seed ?? 'unknown'}` : `code: ${namesOf(names)}`))
  if (!known) parts.push('code not known')
  return parts.join(', ') || 'nothing'
}

const MOST = 3

/** Where the code changed within a trend. */
export function changesOf(runs: readonly Pick<TrendRun, 'id' | 'code_changed' | 'code_changes' | 'code'>[]): string {
  const changed = runs.filter((run) => run.code_changed).map(({ id, code_changes: names }) => `${id} (${namesOf(names)})`)
  if (changed.length > 0) {
    const named = changed.length > MOST ? `${changed.slice(-MOST).join(', ')} and ${changed.length - MOST} earlier` : changed.join(', ')
    return `The code changed before ${named}`
  }
  // A campaign with another baseline or stage uses other parts of the same code, which has another digest.
  const digests = new Set(runs.map(({ code }) => code))
  return digests.size <= 1 && !digests.has(null) ? 'All runs used the same code' : 'No change of the code is known'
}
