// State written to the address is read back unchanged.
import { expect, it } from 'vitest'
import { readUsers } from '../access/search'
import { readCompare } from '../compare/search'
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

it.each(['true', 'false', '1', 'null', '-5e-7'])('the word %s is a filter as any other one', (word) => {
  const search = { q: word, tag: [word], campaign: [word, 'x'], owner: [word], method: [word], label: [`a=${word}`] }
  expect(readSearch(parseSearch(stringifySearch(search)))).toEqual(search)
})

it('a page sets a flag and reads it again', () => {
  expect(readSearch(parseSearch(stringifySearch({ pinned: true, removed: true })))).toEqual({ pinned: true, removed: true })
  expect(readUsers(parseSearch('?invite=true'))).toEqual({ invite: true })
  expect(readCompare(parseSearch('?runs=R-0001&all=true'))).toEqual({ runs: 'R-0001', all: true })
})
