// Dragging in a drawing: start and current position in the drawing's pixels, and a click if nothing moved.
import { type PointerEvent, useRef } from 'react'

const STILL = 3

interface Drag {
  /** While dragged: from and to [px]. */
  onDrag: (from: [number, number], to: [number, number]) => void
  /** Position of the click. */
  onClick: (at: [number, number]) => void
  /** Hover position without a button pressed; null when it leaves. */
  onOver?: (at: [number, number] | null) => void
  /** State at the start of a drag. */
  onStart?: (at: [number, number]) => void
}

export function useDrag({ onDrag, onClick, onOver, onStart }: Drag) {
  const began = useRef<{ at: [number, number]; moved: boolean } | null>(null)
  const placeOf = (event: PointerEvent<SVGElement>): [number, number] => {
    const frame = (event.currentTarget.ownerSVGElement ?? event.currentTarget).getBoundingClientRect()
    return [event.clientX - frame.left, event.clientY - frame.top]
  }
  return {
    onPointerDown: (event: PointerEvent<SVGElement>) => {
      if (event.button !== 0) return
      event.currentTarget.setPointerCapture(event.pointerId)
      began.current = { at: placeOf(event), moved: false }
      onStart?.(began.current.at)
    },
    onPointerMove: (event: PointerEvent<SVGElement>) => {
      const at = placeOf(event)
      const drag = began.current
      if (!drag) return onOver?.(at)
      drag.moved ||= Math.hypot(at[0] - drag.at[0], at[1] - drag.at[1]) > STILL
      if (drag.moved) onDrag(drag.at, at)
    },
    onPointerUp: () => {
      if (began.current && !began.current.moved) onClick(began.current.at)
      began.current = null
    },
    onPointerCancel: () => {
      began.current = null
    },
    onPointerLeave: () => onOver?.(null),
  }
}
