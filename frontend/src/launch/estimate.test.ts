// The bound of a run and its time.
import { expect, it } from 'vitest'
import type { Estimate } from '../client'
import { amountOf, timeOf } from './estimate'

const usual: Estimate = {
  ...{ evaluations: 14_515, least: 12_600, most: 22_300, stages: [], statement: '', run: null },
  ...{ seconds: 12, seconds_least: 10, seconds_most: 90, time_statement: '' },
}

it('announces the one number that bounds a run, and its time', () => {
  expect(amountOf(usual)).toBe('at most 22\u202f300')
  expect(timeOf(usual)).toBe('about 12.0\u202fs, at most 1:30\u202fmin')
  expect(timeOf({ ...usual, seconds: null, seconds_least: null, seconds_most: null })).toBeUndefined()
  expect(timeOf({ ...usual, seconds_most: null })).toBe('about 12.0\u202fs')
})
