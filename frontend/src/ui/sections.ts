// Order of a page's sections, and which of them is current while it scrolls.

export interface Placed {
  id: string
  /** From the top of the window [px]. */
  top: number
  left: number
}

/** Sections that begin within this distance are in one row [px]. */
const ROW = 8

/** As they are read: by rows from the top, within a row from the left. */
export function inPageOrder<T extends Placed>(sections: readonly T[]): T[] {
  const sorted = [...sections].sort((a, b) => a.top - b.top || a.left - b.left)
  const rows: T[][] = []
  for (const section of sorted) {
    const row = rows.at(-1)
    if (row?.[0] && section.top - row[0].top <= ROW) row.push(section)
    else rows.push([section])
  }
  return rows.flatMap((row) => row.sort((a, b) => a.left - b.left))
}

/**
 * The section at the reading line: the last one in page order that begins above it, the first of its row.
 * `target`: the one that was jumped to, which is current although another one is next to it or the page ends below it.
 */
export function currentOf(sections: readonly Placed[], line: number, target?: string): string | undefined {
  const ordered = inPageOrder(sections)
  if (target !== undefined && ordered.some(({ id }) => id === target)) return target
  const last = ordered.findLast(({ top }) => top <= line) ?? ordered[0]
  return last && ordered.find(({ top }) => Math.abs(top - last.top) <= ROW)?.id
}

interface Scrolled {
  /** Height of the window. */
  height: number
  /** How far the page is scrolled, and how far it can be. */
  at: number
  most: number
}

/** The reading line [px]: below the header, and towards the end of the page down to the bottom of the window, so that every section passes it. */
export function lineOf({ height, at, most }: Scrolled, below: number): number {
  const reach = Math.min(height - below, most)
  const left = most - at
  if (reach <= 0 || left >= reach) return below
  return below + (height - below) * (1 - Math.max(0, left) / reach)
}
