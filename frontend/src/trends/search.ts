// The state of the trend page in the address.
import { pairs, words } from '../format/query'
import type { Along } from './axis'

export interface TrendSearch {
  /** The digest of a campaign. */
  campaign?: string
  /** The name of campaigns. */
  name?: string
  /** Labels that the runs have, key=value; alternatives of one key, every key required. */
  label?: string[]
  /** The horizontal axis, if it is not the one that suits the runs. */
  along?: Along
}

export function readTrend(search: Record<string, unknown>): TrendSearch {
  const { campaign, name } = search
  const along: Pick<TrendSearch, 'along'> = search.along === 'time' || search.along === 'order' ? { along: search.along } : {}
  const labels = words(pairs(search.label))
  const rest = { ...(labels && { label: labels }), ...along }
  if (typeof campaign === 'string' && /^[0-9a-f]{64}$/.test(campaign)) return { campaign, ...rest }
  return typeof name === 'string' && name ? { name: name.slice(0, 120), ...rest } : {}
}
