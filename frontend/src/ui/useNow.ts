// The current time [s since 1970], updated at an interval, for ages on the page.
import { useEffect, useState } from 'react'

export function useNow(interval: number, on = true): number {
  const [now, setNow] = useState(() => Date.now() / 1000)
  useEffect(() => {
    if (!on) return
    const timer = setInterval(() => setNow(Date.now() / 1000), interval)
    return () => clearInterval(timer)
  }, [interval, on])
  return now
}
