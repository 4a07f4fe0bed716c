// Since when a run has stored no evaluation, if it stands still; what the header shows.
import { useQuery } from '@tanstack/react-query'
import { workersQuery } from './queries'

/** In seconds since 1970; null if the run moves. */
export function useStill(run: string): number | null {
  const { data } = useQuery(workersQuery)
  return data?.still.find((one) => one.run === run)?.since ?? null
}
