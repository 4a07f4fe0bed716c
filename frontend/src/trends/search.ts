// The state of the trend page in the address.
import type { Along } from './axis'

export interface TrendSearch {
  /** The digest of a campaign. */
  campaign?: string
  /** The name of campaigns. */
  name?: string
  /** The horizontal axis, if it is not the one that suits the runs. */
  along?: Along
}

export function readTrend(search: Record<string, unknown>): TrendSearch {
  const { campaign, name } = search
  const along: Pick<TrendSearch, 'along'> = search.along === 'time' || search.along === 'order' ? { along: search.along } : {}
  if (typeof campaign === 'string' && /^[0-9a-f]{64}$/.test(campaign)) return { campaign, ...along }
  return typeof name === 'string' && name ? { name: name.slice(0, 120), ...along } : {}
}
