// Row virtualisation: only rows near the window are in the page, so that ten thousand rows are as fast as fifty.
import { useWindowVirtualizer } from '@tanstack/react-virtual'
import { type RefObject, useSyncExternalStore } from 'react'

const OVERSCAN = 15
/** Height of the sticky headers of page and table, and the space below a row [px]. */
const [HEADERS, BELOW] = [110, 8]

export interface Rows {
  /** The first row in the page, and the one after the last. */
  first: number
  end: number
  /** Scrolls a row into view. */
  reveal: (index: number) => void
}

/** The rendered rows of a table; all have the same height, and the table scrolls with the window. */
export function useRows(body: RefObject<HTMLElement | null>, height: number, count: number): Rows {
  // The height of the filters above the table can change.
  const top = useSyncExternalStore(resized, () =>
    body.current ? Math.round(body.current.getBoundingClientRect().top + scrollY) : 0,
  )
  const rows = useWindowVirtualizer({
    count,
    estimateSize: () => height,
    overscan: OVERSCAN,
    scrollMargin: top,
    scrollPaddingStart: HEADERS,
    scrollPaddingEnd: BELOW,
  })
  const items = rows.getVirtualItems()
  const first = items[0]?.index ?? 0
  return {
    first,
    end: (items.at(-1)?.index ?? first - 1) + 1,
    reveal: (index) => rows.scrollToIndex(index, { behavior: 'instant' }),
  }
}

function resized(changed: () => void): () => void {
  addEventListener('resize', changed)
  return () => removeEventListener('resize', changed)
}
