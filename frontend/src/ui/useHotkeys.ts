// Single keys of a page. They never fire while something is being typed or a dialog is open.
import { useEffect, useEffectEvent } from 'react'

const typed = (target: EventTarget): boolean =>
  target instanceof HTMLElement &&
  (target.isContentEditable ||
    (/^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName) && !/^(checkbox|radio)$/.test((target as HTMLInputElement).type)) ||
    target.getAttribute('role') === 'dialog')

/** Also in a shadow tree, such as that of the campaign's text: outside of it, its host is the target. */
const typing = (event: KeyboardEvent): boolean => event.composedPath().some(typed)

/** `keys` maps a key, or Ctrl+key, to what it does; Ctrl combinations also fire while typing. */
export function useHotkeys(keys: Record<string, () => void>): void {
  const pressed = useEffectEvent((event: KeyboardEvent) => {
    if (event.altKey || event.defaultPrevented || document.querySelector('dialog')) return
    const control = event.ctrlKey || event.metaKey
    if (!control && typing(event)) return
    const act = keys[control ? `Ctrl+${event.key}` : event.key]
    if (act) {
      event.preventDefault()
      act()
    }
  })
  useEffect(() => {
    document.addEventListener('keydown', pressed)
    return () => document.removeEventListener('keydown', pressed)
  }, [])
}
