// Whether an axis includes the criterion: if it is far from all values, these would be flattened to one line, so it is
// omitted with a note, and included on request.
import { type ReactNode, useState } from 'react'
import { exact } from '../format/numbers'
import { Seg } from '../ui/Card'
import { figures } from '../ui/styles'
import { extremes } from './ticks'

export interface Reach {
  /** The criterion, if the axis includes it. */
  criterion: number | null
  /** The control, if there is a choice. */
  choice: ReactNode
  /** The note about the omitted criterion. */
  note: ReactNode
}

export function useReach(values: readonly number[], threshold: number | null, unit: string, axis: string): Reach {
  const [extent, setExtent] = useState<'near' | 'all'>('near')
  if (threshold === null || !isFar(values, threshold)) return { criterion: threshold, choice: null, note: null }
  const out = extent === 'near'
  return {
    criterion: out ? null : threshold,
    choice: <Seg label="Vertical axis" options={{ near: 'Values', all: 'With criterion' }} value={extent} onChange={setExtent} />,
    note: out && (
      <p className={figures.fig}>
        The criterion, {exact(threshold)} {unit}, is outside {axis}.
      </p>
    ),
  }
}

/** Whether a value is more than six spreads away from all others. */
export function isFar(values: readonly number[], value: number): boolean {
  const [low, high] = extremes(values) ?? [value, value]
  return Math.max(low - value, value - high) > 6 * (high - low)
}
