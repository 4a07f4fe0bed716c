// Returns the focus to what had it when a dialog opened. Mantine stores that once the dialog has the focus already, from the
// second opening on, and not at all for a dialog that is mounted open.
import { useLayoutEffect } from 'react'

/** Time in which the page may place the focus elsewhere first, as Mantine has it [ms]. */
const REST = 10

/** For a dialog with `returnFocus={false}`. */
export function useReturnFocus(opened: boolean): void {
  useLayoutEffect(() => {
    if (!opened) return
    const before = document.activeElement
    return () => {
      const within = document.activeElement
      setTimeout(() => {
        const now = document.activeElement
        if (before instanceof HTMLElement && (now === null || now === document.body || now === within)) before.focus({ preventScroll: true })
      }, REST)
    }
  }, [opened])
}
