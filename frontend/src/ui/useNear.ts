// Whether an element has come near the window, or the page is printed; defers what is expensive until then.
import { type RefObject, useEffect, useRef, useState } from 'react'
import { flushSync } from 'react-dom'

/** A reference for the element, and true once it has been near; stays true. */
export function useNear<T extends HTMLElement>(): [RefObject<T | null>, boolean] {
  const element = useRef<T>(null)
  const [near, setNear] = useState(false)
  useEffect(() => {
    const place = element.current
    if (!place || near) return
    const observer = new IntersectionObserver(([entry]) => entry?.isIntersecting && setNear(true), {
      rootMargin: '200px',
    })
    const printed = () => flushSync(() => setNear(true))
    observer.observe(place)
    addEventListener('beforeprint', printed)
    return () => {
      observer.disconnect()
      removeEventListener('beforeprint', printed)
    }
  }, [near])
  return [element, near]
}
