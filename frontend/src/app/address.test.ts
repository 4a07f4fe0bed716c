// State written to the address is read back unchanged.
import { expect, it } from 'vitest'
import { readSearch } from '../runs/search'
import { onlyKnown, parseSearch, stringifySearch } from './address'

it.each([
  [{}, ''],
  [{ q: 'a b&c', sort: '-margin' }, '?q=a+b%26c&sort=-margin'],
  [{ tag: ['one'] }, '?tag=one'],
  [{ campaign: ['UAV, intruder', 'x'], pinned: true, days: 7 }, '?campaign=UAV,+intruder&campaign=x&pinned=true&days=7'],
  [{ cols: ['worst', 'tags'] }, '?cols=worst&cols=tags'],
  [{ cols: [] }, '?cols='],
  [{ since: '2026-11-03', show: 'failed' }, '?since=2026-11-03&show=failed'],
] as const)('writes %j', (search, text) => {
  expect(stringifySearch(search)).toBe(text)
  expect(readSearch(parseSearch(text))).toEqual(search)
})

it('leaves out what is not set', () => {
  expect(stringifySearch({ a: undefined, b: null })).toBe('')
})

it('takes nothing for granted that a page does not know', () => {
  const raw = { show: 'odd', q: 'a', other: '1' }
  expect({ ...raw, ...onlyKnown(readSearch)(raw) }).toEqual({ q: 'a', show: undefined, other: undefined })
})
