// The columns of the run list in their order; those of a result are adjacent, because rows without one span them.

export const COLUMN_KEYS = [
  'verdict',
  'worst',
  'nominal',
  'criterion',
  'margin',
  'method',
  'bound',
  'evaluations',
  'failed',
  'excluded',
  'course',
  'campaign',
  'tags',
  'duration',
  'submitted',
  'started',
  'finished',
  'owner',
] as const
export type ColumnKey = (typeof COLUMN_KEYS)[number]

export const USUAL: readonly ColumnKey[] = [
  'verdict',
  'worst',
  'criterion',
  'margin',
  'method',
  'bound',
  'course',
  'tags',
  'duration',
  'submitted',
  'owner',
]

/** Columns of removed runs, where the reason needs room. */
export const USUAL_REMOVED: readonly ColumnKey[] = ['verdict', 'worst', 'margin', 'tags', 'submitted']

/** Default columns that are omitted where the list is narrower than this, so that the others are whole [px]. */
export const WIDE_ONLY: Partial<Record<ColumnKey, number>> = { duration: 1300, owner: 1300, tags: 1226, method: 1226 }
