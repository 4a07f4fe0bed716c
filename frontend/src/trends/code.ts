// The code of runs in words: what is not known of it, and what differs.

/** Why a run has no digest of its code. */
export const unreadOf = (identity: { unidentified: readonly string[] } | null | undefined): string =>
  identity && identity.unidentified.some((name) => name !== 'engine') ? `not identified: ${identity.unidentified.join(', ')}` : 'code not stored'

/** The names of what differs, the first few. */
export const namesOf = (names: readonly string[], most = 3): string =>
  names.length > most ? `${names.slice(0, most).join(', ')} and ${names.length - most} more` : names.join(', ')
