// Places cards of different heights in two balanced columns.
import { clsx } from 'clsx'
import type { ReactNode } from 'react'
import { balanced, type Weighed } from './balanced'
import { layout } from '../ui/styles'
import styles from './run.module.css'

export interface Piece extends Weighed {
  card: ReactNode
}

/** False and null are skipped; a single card has the full width. */
export function Columns({ pieces }: { pieces: readonly (Piece | false | null)[] }) {
  const there = pieces.filter((piece): piece is Piece => Boolean(piece))
  if (there.length === 0) return null
  if (there.length === 1) return <div className={clsx(layout.stack, layout.c12)}>{there[0]?.card}</div>
  return balanced(there).map((column, i) => (
    <div key={i} className={clsx(layout.stack, styles.filled, layout.c6, layout.wide)}>
      {column.map((piece) => piece.card)}
    </div>
  ))
}
