// The order of the section tabs and which one is current.
import { expect, it } from 'vitest'
import { currentOf, inPageOrder, lineOf } from './sections'

const at = (id: string, top: number, left = 0) => ({ id, top, left })
const ids = (sections: { id: string }[]) => sections.map(({ id }) => id)
/** Two columns of cards of different heights, in the order of the document. */
const PAGE = [at('flight', 0), at('sample', 500), at('encounter', 900), at('validation', 503, 700), at('space', 1200), at('notes', 1700, 700), at('signoff', 1700)]

it('orders sections by rows from the top and within a row from the left, whatever the document', () => {
  expect(ids(inPageOrder(PAGE))).toEqual(['flight', 'sample', 'validation', 'encounter', 'space', 'signoff', 'notes'])
  expect(inPageOrder([])).toEqual([])
})

it('makes every row current in turn while the page scrolls, and never goes back', () => {
  const order = ids(inPageOrder(PAGE))
  const [height, whole] = [900, 2000]
  const most = whole - height
  const seen: string[] = []
  for (let scroll = 0; scroll <= most; scroll += 5) {
    const moved = PAGE.map((section) => ({ ...section, top: section.top - scroll + 300 }))
    const current = currentOf(moved, lineOf({ height, at: scroll, most }, 170)) ?? ''
    if (seen.at(-1) !== current) seen.push(current)
  }
  expect(seen).toEqual(['flight', 'sample', 'encounter', 'space', 'signoff'])
  expect(seen.map((id) => order.indexOf(id))).toEqual(seen.map((id) => order.indexOf(id)).toSorted((a, b) => a - b))
})

it('keeps the section that was jumped to, also next to another one and at the end of the page', () => {
  const moved = PAGE.map((section) => ({ ...section, top: section.top - 400 }))
  expect(currentOf(moved, 170)).toBe('sample')
  expect(currentOf(moved, 170, 'validation')).toBe('validation')
  expect(currentOf(moved, 170, 'notes')).toBe('notes')
  expect(currentOf(moved, 170, 'no such section')).toBe('sample')
  expect(currentOf([], 170)).toBeUndefined()
})

it('reads below the header until the end of the page comes near; a page that does not scroll is read at its top', () => {
  expect(lineOf({ height: 900, at: 0, most: 5000 }, 170)).toBe(170)
  expect(lineOf({ height: 900, at: 5000, most: 5000 }, 170)).toBe(900)
  expect(lineOf({ height: 900, at: 5001, most: 5000 }, 170)).toBe(900)
  expect(lineOf({ height: 900, at: 0, most: 0 }, 170)).toBe(170)
  expect(lineOf({ height: 900, at: 0, most: 100 }, 170)).toBe(170)
})
