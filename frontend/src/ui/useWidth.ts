// The width of an element [px], kept up to date, so that drawings are laid out again instead of stretched.
import { type RefObject, useLayoutEffect, useRef, useState } from 'react'

export function useWidth(first: number): [RefObject<HTMLDivElement | null>, number] {
  const element = useRef<HTMLDivElement>(null)
  const [width, setWidth] = useState(first)
  useLayoutEffect(() => {
    const holder = element.current
    if (!holder) return
    const observer = new ResizeObserver(
      ([entry]) => entry && setWidth(Math.max(120, Math.floor(entry.contentRect.width))),
    )
    observer.observe(holder)
    return () => observer.disconnect()
  }, [])
  return [element, width]
}
