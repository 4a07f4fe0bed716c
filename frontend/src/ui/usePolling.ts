// Polls at an interval while a page is visible. The query's own interval would restart with every event that the stream
// writes into the cache, and never elapse.
import { useEffect, useEffectEvent } from 'react'

export function usePolling(ask: () => unknown, interval: number, on: boolean): void {
  const tick = useEffectEvent(() => document.hidden || ask())
  useEffect(() => {
    if (!on) return
    const timer = setInterval(tick, interval)
    return () => clearInterval(timer)
  }, [interval, on])
}
