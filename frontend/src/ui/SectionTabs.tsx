// The tabs below the figures: links to the sections in page order, with the one that is read highlighted.
import { clsx } from 'clsx'
import { useCallback, useEffect, useRef, useState } from 'react'
import { count } from '../format/numbers'
import { useHotkeys } from './useHotkeys'
import { currentOf, inPageOrder, lineOf, type Placed } from './sections'
import { layout } from './styles'
import styles from './sections.module.css'

export interface Section {
  id: string
  name: string
  count?: number
}

/** The reading line below the header and the tabs [px]. */
const LINE = 170

/** What a visitor scrolls with; a jump to a section is none of them. */
const SCROLLS = ['wheel', 'touchmove', 'pointerdown', 'keydown'] as const

export function SectionTabs({ sections }: { sections: Section[] }) {
  const [shown, setShown] = useState({ order: sections.map(({ id }) => id), current: sections[0]?.id })
  const { order, current } = shown
  const bar = useRef<HTMLElement>(null)
  const target = useRef<string | undefined>(undefined)
  const ids = sections.map(({ id }) => id).join()
  const read = useCallback(() => {
    const places = placesOf(ids.split(','))
    const found = inPageOrder(places).map(({ id }) => id)
    const [height, whole] = [innerHeight, document.documentElement.scrollHeight]
    const at = currentOf(places, lineOf({ height, at: scrollY, most: whole - height }, LINE), target.current)
    setShown((before) => (before.current === at && before.order.join() === found.join() ? before : { order: found, current: at }))
  }, [ids])
  useEffect(() => {
    const scrolled = () => {
      target.current = undefined
    }
    // Cards that are loaded later, and other widths of the window, move the sections.
    const moved = new ResizeObserver(read)
    moved.observe(document.body)
    addEventListener('scroll', read, { passive: true })
    for (const kind of SCROLLS) addEventListener(kind, scrolled, { capture: true, passive: true })
    return () => {
      moved.disconnect()
      removeEventListener('scroll', read)
      for (const kind of SCROLLS) removeEventListener(kind, scrolled, { capture: true })
    }
  }, [read])
  useEffect(() => {
    // In the next frame, whose layout is computed anyway.
    const frame = requestAnimationFrame(() => {
      const tab = bar.current?.querySelector<HTMLElement>('[aria-current]')
      if (tab && bar.current) bar.current.scrollLeft = tab.offsetLeft - (bar.current.clientWidth - tab.clientWidth) / 2
    })
    return () => cancelAnimationFrame(frame)
  }, [current])
  const jumped = (id: string) => {
    target.current = id
    setShown((before) => ({ ...before, current: id }))
  }
  const ordered = inOrder(sections, order)
  useHotkeys(
    Object.fromEntries(
      ordered.map(({ id }, i) => [
        String(i + 1),
        () => {
          jumped(id)
          document.getElementById(id)?.scrollIntoView()
        },
      ]),
    ),
  )
  return (
    <nav className={clsx(layout.tabs, styles.subnav)} aria-label="Sections" ref={bar}>
      {ordered.map(({ id, name, count: number }) => (
        <a key={id} href={`#${id}`} aria-current={id === current ? 'true' : undefined} onClick={() => jumped(id)}>
          {name}
          {number !== undefined && <span className={clsx('mut', styles.n)}>{count(number)}</span>}
        </a>
      ))}
    </nav>
  )
}

const placesOf = (ids: readonly string[]): Placed[] =>
  ids.flatMap((id) => {
    const box = document.getElementById(id)?.getBoundingClientRect()
    return box ? [{ id, top: box.top, left: box.left }] : []
  })

/** Sections that are not on the page yet keep their place among the others. */
function inOrder(sections: readonly Section[], order: readonly string[]): Section[] {
  const rank = (id: string) => order.indexOf(id)
  const placed = sections.filter(({ id }) => rank(id) >= 0).sort((a, b) => rank(a.id) - rank(b.id))
  return sections.map((section) => (rank(section.id) < 0 ? section : (placed.shift() ?? section)))
}
