// A number where it is known well enough, otherwise its range.
import { expect, it } from 'vitest'
import type { Estimate } from '../client'
import { amountOf, stageOf, timeOf } from './estimate'

const ranged: Estimate = {
  ...{ evaluations: 14_515, least: 12_600, most: 22_300, near: false, stages: [], statement: '', run: null },
  ...{ seconds: 12, seconds_least: 10, seconds_most: 90, time_statement: '' },
}

it('announces a range of evaluations and of time', () => {
  expect(amountOf(ranged)).toBe('12\u202f600 to 22\u202f300')
  expect(timeOf(ranged)).toBe('10.0\u202fs to 1:30\u202fmin')
  expect(timeOf({ ...ranged, seconds: null, seconds_least: null, seconds_most: null })).toBeUndefined()
})

it('announces one number where nothing in the range is far from it, or an earlier run had it', () => {
  expect(amountOf({ ...ranged, near: true })).toBe('14\u202f515')
  expect(timeOf({ ...ranged, near: true })).toBe('about 12.0\u202fs')
  const stage = { kind: 'search', title: 'Search', evaluations: 9000, least: 9000, most: 9000 }
  expect(stageOf(stage)).toBe('9\u202f000')
  expect(stageOf({ ...stage, most: 9500 })).toBe('9\u202f000 to 9\u202f500')
})
