// Loads a run and keeps it up to date while it is active.
import { useQuery, type UseQueryResult } from '@tanstack/react-query'
import { useStream } from '../../api/events'
import { isLive, runQuery } from '../../api/queries'
import type { RunDetail } from '../../client'
import { usePolling } from '../../ui/usePolling'
import { useRequests } from './data'

export function useRun(id: string): UseQueryResult<RunDetail> {
  const query = useQuery(runQuery(id))
  useRequests(id)
  const live = query.data !== undefined && isLive(query.data)
  useStream(id, live)
  // The stream has neither speed nor remaining time; polling also covers its failure.
  usePolling(query.refetch, 2000, live)
  return query
}
