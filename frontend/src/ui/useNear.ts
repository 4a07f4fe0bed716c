// Whether an element has come near the window, or may be printed; defers expensive requests until then.
import { type RefObject, useCallback, useEffect, useRef, useState } from 'react'
import { useCalm } from './useCalm'

/** A reference for the element, and true once it has been near; stays true. The last sets that it has been. */
export function useNear<T extends HTMLElement>() {
  const element = useRef<T>(null)
  const [near, setNear] = useState(false)
  useEffect(() => {
    const target = element.current
    if (!target || near) return
    const observer = new IntersectionObserver(([entry]) => entry?.isIntersecting && setNear(true), {
      rootMargin: '200px',
    })
    observer.observe(target)
    return () => observer.disconnect()
  }, [near])
  return [element, near, setNear] as const
}

/** The same, true also once a print may be about to begin, because what is printed must have been read by then. */
export function useNearOrPrint<T extends HTMLElement>(): [RefObject<T | null>, boolean] {
  const [element, near, setNear] = useNear<T>()
  useBeforePrint(useCallback(() => setNear(true), [setNear]))
  return [element, near]
}

/** Calls when a print may be about to begin: the pointer leaves for the browser's menu, the page's menu opens, or the first key
 * of a shortcut is pressed; on a touch screen once the page is calm. */
export function useBeforePrint(prepare: () => void): void {
  const calm = useCalm()
  useEffect(() => {
    const pressed = ({ ctrlKey, metaKey, altKey, key }: KeyboardEvent) => (ctrlKey || metaKey || altKey || key === 'F10') && prepare()
    const { documentElement: page } = document
    if (calm && matchMedia('(hover: none)').matches) prepare()
    page.addEventListener('mouseleave', prepare)
    addEventListener('contextmenu', prepare)
    addEventListener('keydown', pressed)
    return () => {
      page.removeEventListener('mouseleave', prepare)
      removeEventListener('contextmenu', prepare)
      removeEventListener('keydown', pressed)
    }
  }, [prepare, calm])
}
