// Letters typed before the search dialog is there.
import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { keepTyped, typedEarly } from './early'

let page: EventTarget
let reached: string[]

function press(...keys: string[]): void {
  for (const key of keys) page.dispatchEvent(Object.assign(new Event('keydown', { cancelable: true }), { key, ctrlKey: false, altKey: false, metaKey: false }))
}

beforeEach(() => {
  page = new EventTarget()
  reached = []
  vi.stubGlobal('document', page)
  vi.useFakeTimers()
  keepTyped()
  // As the keys of the page, which ignore what was handled; a document calls them later, too.
  page.addEventListener('keydown', (event) => event.defaultPrevented || reached.push((event as KeyboardEvent).key))
})

afterEach(() => {
  typedEarly()
  vi.useRealTimers()
  vi.unstubAllGlobals()
})

it('keeps letters for the field, and from the keys of the page', () => {
  press('n', 'o', 'x', 'Backspace', 'i', 'Enter')
  expect([typedEarly(), reached]).toEqual(['noi', []])
  press('n')
  expect([typedEarly(), reached]).toEqual(['', ['n']])
})

it('gives the keys back if the dialog never comes, and leaves Escape to the page', () => {
  press('Escape')
  vi.advanceTimersByTime(5000)
  press('n')
  expect(reached).toEqual(['Escape', 'n'])
})
