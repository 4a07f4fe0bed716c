// Only the rows near the window are in the page, however long the list: ten thousand rows stay as fast as fifty.
import { type RefObject, useEffect, useState } from 'react'

const OVERSCAN = 10
/** Ranges move in steps, so that most scrolling changes nothing. */
const STEP = 8

export interface Range {
  first: number
  /** Behind the last. */
  end: number
}

/** The rows to have in the page, given where the list's top is in the window [px]. */
export function rangeOf(top: number, height: number, row: number, count: number): Range {
  const above = Math.max(0, Math.floor(-top / row) - OVERSCAN)
  const below = Math.max(0, Math.ceil((height - top) / row) + OVERSCAN)
  const end = Math.min(count, below)
  return { first: Math.min(above, end), end }
}

/** The range of a body of equal rows that scrolls with the window, and a way to bring a row into view. */
export function useWindowed(
  body: RefObject<HTMLElement | null>,
  row: number,
  count: number,
): Range & { reveal: (index: number) => void } {
  const [{ top, height }, setPlace] = useState({ top: 200, height: 900 })
  useEffect(() => {
    const read = () => {
      if (!body.current) return
      const fine = body.current.getBoundingClientRect().top
      const next = { top: Math.ceil(fine / (STEP * row)) * STEP * row, height: innerHeight + STEP * row }
      setPlace((before) => (before.top === next.top && before.height === next.height ? before : next))
    }
    const frame = requestAnimationFrame(read)
    addEventListener('scroll', read, { passive: true })
    addEventListener('resize', read)
    return () => {
      cancelAnimationFrame(frame)
      removeEventListener('scroll', read)
      removeEventListener('resize', read)
    }
  }, [body, row])
  const reveal = (index: number) => {
    if (!body.current) return
    const at = body.current.getBoundingClientRect().top + index * row
    // Below the sticky heads of the page and of the table.
    const [upper, lower] = [110, innerHeight - row - 8]
    if (at < upper) scrollBy({ top: at - upper, behavior: 'instant' })
    else if (at > lower) scrollBy({ top: at - lower, behavior: 'instant' })
  }
  return { ...rangeOf(top, height, row, count), reveal }
}
