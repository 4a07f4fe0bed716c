// The usual number and the bound of a run.
import { expect, it } from 'vitest'
import type { Estimate } from '../client'
import { amountOf, stageOf, timeOf } from './estimate'

const usual: Estimate = {
  ...{ evaluations: 14_515, least: 12_600, most: 22_300, stages: [], statement: '', run: null },
  ...{ seconds: 12, seconds_least: 10, seconds_most: 90, time_statement: '' },
}

it('announces the usual number and the bound', () => {
  expect(amountOf(usual)).toBe('about 14\u202f515, at most 22\u202f300')
  expect(timeOf(usual)).toBe('about 12.0\u202fs, at most 1:30\u202fmin')
  expect(timeOf({ ...usual, seconds: null, seconds_least: null, seconds_most: null })).toBeUndefined()
  expect(timeOf({ ...usual, seconds_most: null })).toBe('about 12.0\u202fs')
})

it('announces one number where nothing is uncertain', () => {
  expect(amountOf({ ...usual, most: 14_515 })).toBe('14\u202f515')
  const stage = { kind: 'search', title: 'Search', evaluations: 9000, least: 9000, most: 9000 }
  expect(stageOf(stage)).toBe('9\u202f000')
  expect(stageOf({ ...stage, most: 9500 })).toBe('9\u202f000, at most 9\u202f500')
})
