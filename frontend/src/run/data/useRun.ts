// Loads a run and keeps it up to date while it is active.
import { usePrefetchQuery, useQuery, type UseQueryResult } from '@tanstack/react-query'
import { useStream } from '../../api/events'
import { componentsQuery, evaluationsQuery, findingsQuery, isLive, runQuery, stagesQuery } from '../../api/queries'
import type { RunDetail } from '../../client'
import { usePolling } from '../../ui/usePolling'

export function useRun(id: string): UseQueryResult<RunDetail> {
  const query = useQuery(runQuery(id))
  // Its data are requested in parallel with the run itself.
  usePrefetchQuery(stagesQuery(id))
  usePrefetchQuery(findingsQuery(id))
  usePrefetchQuery(evaluationsQuery(id))
  usePrefetchQuery(componentsQuery(id))
  const live = query.data !== undefined && isLive(query.data)
  useStream(id, live)
  // The stream has neither speed nor remaining time; polling also covers its failure.
  usePolling(query.refetch, 2000, live)
  return query
}
