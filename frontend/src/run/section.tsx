// A section of the page of a run that has ended: its tab, its condition and its card.
import { clsx } from 'clsx'
import { Fragment, type ReactNode } from 'react'
import { Columns, type Piece } from './Columns'
import type { RunData } from './data/data'
import type { Facts } from './facts'
import type { WhatIfState } from './flight/useWhatIf'
import type { View } from './flight/view'
import { layout } from '../ui/styles'
import styles from './run.module.css'

/** What a section is rendered from. */
export interface Page extends Facts {
  data: RunData
  view: View
  whatIf: WhatIfState
  /** The result of the what-if for charts, which may be drawn later. */
  other: WhatIfState['answer']
  /** A time under the pointer of a chart. */
  cross: (time: number) => void
}

type Content = { card: ReactNode } | { pieces: readonly Piece[] }

export interface Section {
  /** Its anchor, if it has a tab. */
  id: string
  /** Its tab; null without one, or if the run has nothing to show here. */
  tab: (page: Page) => { id: string; name: string; count?: number } | null
  /** Its card, or pieces for balanced columns; null if the run has nothing to show here. */
  content: (page: Page) => Content | null
}

/** A section from a file of its own, and the section that it comes after. */
export interface Added {
  after: string
  section: Section
}

interface Parts<T> {
  id: string
  /** The condition: what of the run is shown here. */
  of: (page: Page) => T | false | null | undefined
  title?: string | ((page: Page, of: T) => string)
  count?: (page: Page, of: T) => number | undefined
}

type Rendered<T> =
  | { card: (page: Page, of: T) => ReactNode; pieces?: undefined }
  /** Cards that share two balanced columns with those of neighbouring sections. */
  | { card?: undefined; pieces: (page: Page, of: T) => readonly Piece[] }

/** A row of the table; the condition's value is given to its other parts. */
export function section<T>({ id, title, count, of, ...rendered }: Parts<T> & Rendered<T>): Section {
  return {
    id,
    tab: (page) => {
      const there = of(page)
      if (!there || title === undefined) return null
      const number = count?.(page, there)
      return { id, name: typeof title === 'string' ? title : title(page, there), ...(number !== undefined && { count: number }) }
    },
    content: (page) => {
      const there = of(page)
      if (!there) return null
      return rendered.card ? { card: rendered.card(page, there) } : { pieces: rendered.pieces(page, there) }
    },
  }
}

/** All sections of a run; pieces of neighbouring sections share two columns. */
export function Sections({ sections, page }: { sections: readonly Section[]; page: Page }) {
  const rows: ReactNode[] = []
  let pieces: Piece[] = []
  let columns = 0
  const placed = () => {
    // Counted among the columns alone: other sections may come later, and would mount the cards again.
    if (pieces.length > 0) rows.push(<Columns key={`columns ${columns++}`} pieces={pieces} />)
    pieces = []
  }
  sections.forEach((one, i) => {
    const content = one.content(page)
    if (!content) return
    if ('pieces' in content) return pieces.push(...content.pieces)
    placed()
    rows.push(<Fragment key={`${one.id} ${i}`}>{content.card}</Fragment>)
  })
  placed()
  return (
    <div className={clsx(layout.grid, styles.sections)} ref={isUsed}>
      {rows}
    </div>
  )
}

/** What run.module.css skips, not a card within it. */
const CARD = `.${styles.sections} > section, .${styles.sections} > div > section`

/** A card that is used stays laid out, and cuts nothing off: what may be skipped clips the tips of its charts. */
function isUsed(grid: HTMLElement | null): () => void {
  const used = ({ target }: Event) => {
    const card = target instanceof Element ? target.closest<HTMLElement>(CARD) : null
    if (card) card.style.contentVisibility = 'visible'
  }
  const kinds = ['pointerover', 'focusin']
  for (const kind of kinds) grid?.addEventListener(kind, used)
  return () => kinds.forEach((kind) => grid?.removeEventListener(kind, used))
}
