// Whether an axis reaches to the criterion: where that lies far from all values, they would be flattened to one line, so
// it is left out, said to be, and brought in on request. Start reading at `useReach`.
import { type ReactNode, useState } from 'react'
import { plain } from '../format/numbers'
import { Seg } from '../ui/Card'

export interface Reach {
  /** The criterion, where the axis reaches to it. */
  criterion: number | null
  /** The choice, where there is one. */
  choice: ReactNode
  /** The sentence that says what is left out. */
  note: ReactNode
}

export function useReach(values: readonly number[], threshold: number | null, unit: string, axis: string): Reach {
  const [asked, setAsked] = useState<'near' | 'all'>('near')
  if (threshold === null || !isFar(values, threshold)) return { criterion: threshold, choice: null, note: null }
  const out = asked === 'near'
  return {
    criterion: out ? null : threshold,
    choice: (
      <Seg
        label="Vertical axis"
        options={[
          { value: 'near', label: 'Values' },
          { value: 'all', label: 'With criterion' },
        ]}
        value={asked}
        onChange={setAsked}
      />
    ),
    note: out && (
      <p className="fig">
        The criterion, {plain(threshold)} {unit}, lies off {axis}.
      </p>
    ),
  }
}

/** Whether a value lies more than six spreads away from all others. */
export function isFar(values: readonly number[], value: number): boolean {
  if (values.length === 0) return false
  let low = values[0] as number
  let high = low
  for (const each of values) {
    if (each < low) low = each
    if (each > high) high = each
  }
  return Math.max(low - value, value - high) > 6 * (high - low)
}
