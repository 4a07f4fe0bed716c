// Whether an element has come near the window; defers expensive requests until then.
import { type RefObject, useEffect, useRef, useState } from 'react'

/** A reference for the element, and true once it has been near; stays true. */
export function useNear<T extends HTMLElement>(): [RefObject<T | null>, boolean] {
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
  return [element, near]
}
