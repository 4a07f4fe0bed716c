// Links to the sections of a page in their order, with the current one highlighted while the page scrolls.
import { useEffect, useRef, useState } from 'react'
import { count } from '../format/numbers'
import { useHotkeys } from './useHotkeys'
import styles from './sections.module.css'

export interface Section {
  id: string
  name: string
  count?: number
}

export function SectionTabs({ sections }: { sections: Section[] }) {
  const [current, setCurrent] = useState(sections[0]?.id)
  const bar = useRef<HTMLElement>(null)
  const ids = sections.map((section) => section.id).join()
  useEffect(() => {
    const elements = ids.split(',').flatMap((id) => document.getElementById(id) ?? [])
    const read = () => {
      const line = 170
      const above = elements.filter((element) => element.getBoundingClientRect().top <= line)
      const end = innerHeight + scrollY >= document.documentElement.scrollHeight - 4
      setCurrent((end ? elements[elements.length - 1] : (above[above.length - 1] ?? elements[0]))?.id)
    }
    read()
    addEventListener('scroll', read, { passive: true })
    return () => removeEventListener('scroll', read)
  }, [ids])
  useEffect(() => {
    // In a narrow window the tabs scroll too; only sideways, so that the page stays where it is.
    const tab = bar.current?.querySelector<HTMLElement>('[aria-current]')
    if (bar.current && tab) bar.current.scrollLeft = tab.offsetLeft - (bar.current.clientWidth - tab.offsetWidth) / 2
  }, [current])
  useHotkeys(
    Object.fromEntries(
      sections.map((section, i) => [String(i + 1), () => document.getElementById(section.id)?.scrollIntoView()]),
    ),
  )
  return (
    <nav className={styles.subnav} aria-label="Sections" ref={bar}>
      {sections.map((section) => (
        <a key={section.id} href={`#${section.id}`} aria-current={section.id === current ? 'true' : undefined}>
          {section.name}
          {section.count !== undefined && <span className="n">{count(section.count)}</span>}
        </a>
      ))}
    </nav>
  )
}
