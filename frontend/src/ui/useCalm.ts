// Defers expensive rendering until the page has loaded its main content.
import { useIsFetching } from '@tanstack/react-query'
import { useEffect, useState } from 'react'

/** Required time without pending requests [ms]. */
const CALM = 400

/** True once all requests have been answered and rendered; stays true. */
export function useCalm(): boolean {
  const fetching = useIsFetching() > 0
  const [calm, setCalm] = useState(false)
  useEffect(() => {
    if (fetching || calm) return
    const timer = setTimeout(() => setCalm(true), CALM)
    return () => clearTimeout(timer)
  }, [fetching, calm])
  return calm
}
