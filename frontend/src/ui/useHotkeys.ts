// Single keys of a page. They never fire while something is being typed, or a dialog or a menu is open.
import { useEffect, useEffectEvent } from 'react'

const typed = (target: EventTarget): boolean =>
  target instanceof HTMLElement &&
  (target.isContentEditable ||
    (/^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName) && !/^(checkbox|radio)$/.test((target as HTMLInputElement).type)) ||
    /^(dialog|menu)$/.test(target.getAttribute('role') ?? ''))

/** Keys by which what has the focus is used, and what uses them: a link or a button stays usable whatever a page binds. */
const USES = /^(Enter| )$/
const USED = 'a[href], button, summary'

/** Also in a shadow tree, such as that of the campaign's text: outside of it, its host is the target. */
const typing = (event: KeyboardEvent): boolean => event.composedPath().some(typed)

const using = (event: KeyboardEvent): boolean =>
  USES.test(event.key) && event.composedPath().some((target) => target instanceof Element && target.matches(USED))

/** `keys` maps a key, or Ctrl+key, to what it does; Ctrl combinations also fire while typing. Undefined: nothing now. */
export function useHotkeys(keys: Record<string, (() => void) | undefined>): void {
  const pressed = useEffectEvent((event: KeyboardEvent) => {
    if (event.altKey || event.defaultPrevented || document.querySelector('dialog')) return
    const control = event.ctrlKey || event.metaKey
    if (!control && (typing(event) || using(event))) return
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
