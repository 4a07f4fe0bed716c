import { afterEach, expect, it, vi } from 'vitest'
import { unsaved } from './unsaved'

afterEach(() => vi.unstubAllGlobals())

it('is what would be asked about before the page is left', () => {
  vi.stubGlobal('window', new EventTarget())
  expect(unsaved()).toBe(false)
  const ask = (event: Event) => event.preventDefault()
  window.addEventListener('beforeunload', ask)
  expect(unsaved()).toBe(true)
  window.removeEventListener('beforeunload', ask)
  expect(unsaved()).toBe(false)
})
