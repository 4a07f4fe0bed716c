// A state that ends by itself after a while.
import { useEffect, useState } from 'react'

/** Null at first, and a while [ms] after it was set last. */
export function useBrief<T>(period: number): [T | null, (value: T | null) => void] {
  const [value, setValue] = useState<T | null>(null)
  useEffect(() => {
    if (value === null) return
    const timer = setTimeout(() => setValue(null), period)
    return () => clearTimeout(timer)
  }, [value, period])
  return [value, setValue]
}
