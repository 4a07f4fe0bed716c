// Polls at an interval while a page is visible. The query's own interval would restart with every event that the stream
// writes into the cache, and never elapse.
import { useEffect, useEffectEvent, useState } from 'react'

/** After which a request without an answer is made again [ms]. */
const LOST = 60_000

/** Calls `ask` unless its last answer is still due: a request that takes longer than the interval would be restarted for ever. */
export function inTurn(): (ask: () => unknown) => void {
  let begun = Number.NEGATIVE_INFINITY
  return (ask) => {
    const now = performance.now()
    if (now - begun < LOST) return
    begun = now
    const answered = () => {
      if (begun === now) begun = Number.NEGATIVE_INFINITY
    }
    void new Promise((resolve) => resolve(ask())).then(answered, answered)
  }
}

/** Asks at this interval. */
export function usePolling(ask: () => unknown, interval: number, on: boolean): void {
  const [turn] = useState(inTurn)
  const tick = useEffectEvent(() => document.hidden || turn(ask))
  useEffect(() => {
    if (!on) return
    const timer = setInterval(tick, interval)
    return () => clearInterval(timer)
  }, [interval, on])
}
