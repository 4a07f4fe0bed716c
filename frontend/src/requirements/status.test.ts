import { expect, test } from 'vitest'
import { kindOf } from '../api/requirements'
import { readRequirements } from './search'
import { countsOf, leftOut } from './status'

test('statuses are counted in their order, the worst first', () => {
  const rows = (['met', 'violated', 'met', 'no evidence'] as const).map((status) => ({ status }))
  expect(countsOf(rows)).toEqual([
    ['violated', 1],
    ['no evidence', 1],
    ['met', 2],
  ])
})

test('what a row leaves out is said', () => {
  expect(leftOut({ runs: [], total: 0, removed: 0, sweeps: 0 })).toBe('')
  expect(leftOut({ runs: [], total: 1, removed: 1, sweeps: 2 })).toBe('1 more run; 1 removed run does not count; 2 runs of sweeps do not count')
})

test('the address holds words and a status that exists', () => {
  expect(readRequirements({ q: 'a', status: 'suspect', x: 1 })).toEqual({ q: 'a', status: 'suspect' })
  expect(readRequirements({ q: 7, status: 'toString' })).toEqual({})
})

test('a file is ReqIF or CSV by its name', () => {
  expect(['a.reqif', 'a.XML', 'a.reqifz', 'a.csv', 'reqif'].map(kindOf)).toEqual(['reqif', 'reqif', 'reqif', 'csv', 'csv'])
})
