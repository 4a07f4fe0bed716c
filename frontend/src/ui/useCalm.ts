// Defers expensive rendering until the page has loaded its main content.
import { useQueryClient } from '@tanstack/react-query'
import { type ReactNode, useEffect, useState } from 'react'

/** Required time without pending requests [ms]. */
const CALM = 400

/** True once all requests have been answered and rendered; stays true. Requests in between do not render anything. */
export function useCalm(): boolean {
  const client = useQueryClient()
  const [calm, setCalm] = useState(false)
  useEffect(() => {
    if (calm) return
    let fetching = true
    let timer: ReturnType<typeof setTimeout> | undefined
    const read = () => {
      const now = client.isFetching() > 0
      if (now === fetching) return
      fetching = now
      clearTimeout(timer)
      if (!now) timer = setTimeout(() => setCalm(true), CALM)
    }
    read()
    const end = client.getQueryCache().subscribe(read)
    return () => {
      clearTimeout(timer)
      end()
    }
  }, [client, calm])
  return calm
}

/** What is shown once the page is calm, without rendering anything else again. */
export const OnceCalm = ({ children }: { children: ReactNode }): ReactNode => useCalm() && children
