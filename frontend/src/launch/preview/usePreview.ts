// The nominal flight of the current campaign, simulated by the service on request and then after every edit; the newest
// campaign wins.
import { useQuery } from '@tanstack/react-query'
import { useEffect, useState } from 'react'
import { previewCampaign } from '../../api/calls'
import type { Campaign } from '../../api/campaign'
import type { Checked, Preview } from '../../client'

export interface LivePreview {
  /** Whether every edit is simulated. */
  following: boolean
  follow: (on: boolean) => void
  flown: Preview | undefined
  /** The drawn flight belongs to an earlier campaign. */
  stale: boolean
  /** Elapsed time of the pending simulation [s]; null if none. */
  waited: number | null
  trouble: Error | null
  again: () => void
}

/** `fresh`: the check is of the current campaign. */
export function usePreview(checked: Checked | undefined, fresh: boolean): LivePreview {
  const [following, setFollowing] = useState(false)
  const document = fresh && checked?.ok ? (checked.document as unknown as Campaign) : null
  // Compare only what affects the simulation: budget and name do not.
  const key = document && JSON.stringify([document.scenario, document.criterion])
  const [last, setLast] = useState<{ key: string; flown: Preview } | null>(null)
  const query = useQuery({
    queryKey: ['preview', key],
    queryFn: ({ signal }) => previewCampaign(document as Campaign, signal),
    enabled: following && key !== null,
    retry: false,
    staleTime: Number.POSITIVE_INFINITY,
    gcTime: 120_000,
  })
  if (key !== null && query.data && last?.flown !== query.data) setLast({ key, flown: query.data })
  const waited = useSeconds(query.isFetching ? key : null)
  return {
    following,
    follow: setFollowing,
    flown: last?.flown,
    stale: last !== null && last.key !== key,
    waited,
    trouble: query.isFetching ? null : query.error,
    again: () => void query.refetch(),
  }
}

/** Whole seconds since a start; null without one. */
function useSeconds(what: string | null): number | null {
  const [since, setSince] = useState<{ what: string | null; seconds: number }>({ what: null, seconds: 0 })
  useEffect(() => {
    if (what === null) return
    const began = Date.now()
    const tick = () => setSince({ what, seconds: Math.floor((Date.now() - began) / 1000) })
    const timer = setInterval(tick, 1000)
    return () => clearInterval(timer)
  }, [what])
  if (what === null) return null
  return since.what === what ? since.seconds : 0
}
