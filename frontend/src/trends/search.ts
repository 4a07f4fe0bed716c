// The state of the trend page in the address.

export interface TrendSearch {
  /** The digest of a campaign. */
  campaign?: string
  /** The name of campaigns. */
  name?: string
}

export function readTrend(search: Record<string, unknown>): TrendSearch {
  const { campaign, name } = search
  if (typeof campaign === 'string' && /^[0-9a-f]{64}$/.test(campaign)) return { campaign }
  return typeof name === 'string' && name ? { name: name.slice(0, 120) } : {}
}
