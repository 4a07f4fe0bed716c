// The state of the run list in its address.
import { expect, it } from 'vitest'
import { filterOf, isNarrowed, readSearch } from './search'

it('reads what it knows and leaves out the rest', () => {
  expect(readSearch({})).toEqual({})
  expect(
    readSearch({ q: 7, show: 'cleared', tag: 'a', campaign: ['x', 'y', 'x'], days: '7', sort: '-bound', cols: 'tags,worst,x' }),
  ).toEqual({
    q: '7',
    show: 'cleared',
    tag: ['a'],
    campaign: ['x', 'y'],
    days: 7,
    sort: '-bound',
    cols: ['tags', 'worst', 'x'],
  })
  expect(readSearch({ q: '', show: 'odd', tag: [], days: 3, since: '2026-13-40', until: 'x', pinned: 1 })).toEqual({})
})

it('reads labels and leaves out what is none', () => {
  expect(readSearch({ label: ['branch=main', 'branch', '=x', 'k=', 7] })).toEqual({ label: ['branch=main'] })
  expect(readSearch({ label: 'branch=main' })).toEqual({ label: ['branch=main'] })
  expect(readSearch({ label: 'main' })).toEqual({})
  expect(filterOf({ label: ['branch=main'] })).toEqual({ label: ['branch=main'] })
  expect(isNarrowed({ label: ['branch=main'] })).toBe(true)
})

it('keeps a choice of no columns at all', () => {
  expect(readSearch({ cols: '' })).toEqual({ cols: [] })
})

it('asks the service for the same', () => {
  expect(filterOf({})).toEqual({})
  expect(filterOf({ q: 'a', show: 'violated', tag: ['t'], owner: ['o'], pinned: true, removed: true }, 'name')).toEqual({
    removed: true,
    q: 'a',
    verdict: ['violated'],
    tag: ['t'],
    owner: ['o'],
    pinned: true,
    sort: 'name',
  })
  expect(filterOf({ show: 'running' })).toEqual({ state: ['running', 'cancelling'] })
  expect(filterOf({ show: 'failed' })).toEqual({ state: ['failed'] })
})

it('takes days from midnight to midnight', () => {
  const noon = new Date(2026, 10, 20, 12).getTime()
  const at = (day: number) => new Date(2026, 10, day).getTime() / 1000
  expect(filterOf({ days: 1 }, undefined, noon)).toEqual({ since: at(20) })
  expect(filterOf({ days: 7 }, undefined, noon)).toEqual({ since: at(14) })
  expect(filterOf({ since: '2026-11-03', until: '2026-11-03' })).toEqual({ since: at(3), until: at(4) })
})

it('knows what narrows', () => {
  expect(isNarrowed({ sort: 'name', cols: ['tags'] })).toBe(false)
  expect(isNarrowed({ days: 1 })).toBe(true)
})
