// A run as its pages follow it: asked for, then kept up to date while it works.
import { useQuery, type UseQueryResult } from '@tanstack/react-query'
import { useStream } from '../../api/events'
import { isLive, runQuery } from '../../api/queries'
import type { RunDetail } from '../../client'
import { usePolling } from '../../ui/usePolling'
import { useAsked } from './data'

export function useRun(id: string): UseQueryResult<RunDetail> {
  const query = useQuery(runQuery(id))
  useAsked(id)
  const live = query.data !== undefined && isLive(query.data)
  useStream(id, live)
  // The stream has no rate and no time left; and where it fails, this goes on.
  usePolling(query.refetch, 2000, live)
  return query
}
