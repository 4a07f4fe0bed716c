// The status of a requirement: its word, tone and order, the worst first.
import type { RequirementRow } from '../client'
import { tally } from '../format/names'

export type Status = RequirementRow['status']

export const STATUSES: Record<Status, { word: string; tone: 'ok' | 'bad' | 'unk' | 'que' }> = {
  violated: { word: 'Violated', tone: 'bad' },
  inconclusive: { word: 'Inconclusive', tone: 'unk' },
  'not sampled': { word: 'Not sampled', tone: 'unk' },
  'no verdict': { word: 'No verdict', tone: 'que' },
  suspect: { word: 'Suspect', tone: 'unk' },
  unsigned: { word: 'Not signed off', tone: 'unk' },
  'no evidence': { word: 'No evidence', tone: 'que' },
  met: { word: 'Met', tone: 'ok' },
}

export const isStatus = (value: unknown): value is Status => typeof value === 'string' && Object.hasOwn(STATUSES, value)

/** How many of these rows have each status, in the order of the statuses; those that no row has are omitted. */
export function countsOf(rows: readonly Pick<RequirementRow, 'status'>[]): [Status, number][] {
  const counts = tally(rows.map(({ status }) => status))
  return (Object.keys(STATUSES) as Status[]).flatMap((status): [Status, number][] => {
    const count = counts.get(status)
    return count ? [[status, count]] : []
  })
}

/** What a row leaves out, as a sentence. */
export function leftOut({ runs, total, removed, sweeps }: Pick<RequirementRow, 'runs' | 'total' | 'removed' | 'sweeps'>): string {
  const more = total - runs.length
  const parts = [
    more > 0 && `${more} more ${more === 1 ? 'run' : 'runs'}`,
    removed > 0 && `${removed} removed ${removed === 1 ? 'run does' : 'runs do'} not count`,
    sweeps > 0 && `${sweeps} ${sweeps === 1 ? 'run of a sweep does' : 'runs of sweeps do'} not count`,
  ].filter(Boolean)
  return parts.join('; ')
}
