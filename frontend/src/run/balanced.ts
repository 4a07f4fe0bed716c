// Which of two columns each of some cards stands in. Start reading at `balanced`.

export interface Weighed {
  /** About how high it is [px]. */
  height: number
}

/** Two columns that end as near to each other as can be; the first card stands in the first, and each keeps its order. */
export function balanced<T extends Weighed>(pieces: readonly T[]): [T[], T[]] {
  const apart = (left: number) =>
    Math.abs(pieces.reduce((sum, { height }, i) => sum + ((left >> i) & 1 ? height : -height), 0))
  let best = 1
  // Few enough cards to try every way.
  for (let left = 1; left < 1 << pieces.length; left += 2) if (apart(left) < apart(best)) best = left
  return [pieces.filter((_, i) => (best >> i) & 1), pieces.filter((_, i) => !((best >> i) & 1))]
}
