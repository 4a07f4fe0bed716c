// Polls at an interval while a page is visible. The query's own interval would restart with every event that the stream
// writes into the cache, and never elapse.
import { useEffect, useEffectEvent, useRef } from 'react'

/** Asks at this interval, never before the last answer has come: an answer that takes longer must not be asked for again. */
export function usePolling(ask: () => unknown, interval: number, on: boolean): void {
  const asks = useRef(false)
  const tick = useEffectEvent(() => {
    if (document.hidden || asks.current) return
    const answered = () => {
      asks.current = false
    }
    asks.current = true
    void Promise.resolve(ask()).then(answered, answered)
  })
  useEffect(() => {
    if (!on) return
    const timer = setInterval(tick, interval)
    return () => clearInterval(timer)
  }, [interval, on])
}
