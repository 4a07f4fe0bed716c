// Distributes cards over two columns.

export interface Weighed {
  /** Approximate height [px]. */
  height: number
}

/** Two columns with minimal difference in height; the first card is in the first column, the order is kept. */
export function balanced<T extends Weighed>(pieces: readonly T[]): [T[], T[]] {
  const apart = (left: number) =>
    Math.abs(pieces.reduce((sum, { height }, i) => sum + ((left >> i) & 1 ? height : -height), 0))
  let best = 1
  // Few enough cards to try all combinations.
  for (let left = 1; left < 1 << pieces.length; left += 2) if (apart(left) < apart(best)) best = left
  return [pieces.filter((_, i) => (best >> i) & 1), pieces.filter((_, i) => !((best >> i) & 1))]
}
