// What takes the window's thread for long waits until the page has shown what it has come for.
import { useIsFetching } from '@tanstack/react-query'
import { useEffect, useState } from 'react'

/** For how long nothing must have been asked for [ms]. */
const CALM = 400

/** True once everything asked for has come and been drawn for a moment; stays true. */
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
