// The bound of a run, what an earlier run took, and the time.
import { expect, it } from 'vitest'
import type { Estimate } from '../client'
import { amountOf, stageAmountOf, timeOf } from './estimate'

const usual: Estimate = {
  ...{ evaluations: 14_515, least: 12_600, most: 22_300, stages: [], statement: '', run: null },
  ...{ seconds: 12, seconds_least: 10, seconds_most: 90, untimed: [], time_statement: '' },
}

it('announces the one number that bounds a run, and its time', () => {
  expect(amountOf(usual)).toBe('at most 22\u202f300')
  expect(stageAmountOf(usual, usual.run)).toBe('at most 22\u202f300')
  expect(timeOf(usual)).toBe('about 12.0\u202fs, about 1:30\u202fmin with all evaluations')
  expect(timeOf({ ...usual, seconds: null, seconds_least: null, seconds_most: null })).toBeUndefined()
  expect(timeOf({ ...usual, seconds_most: null })).toBe('about 12.0\u202fs')
})

it('claims no time that a run may exceed, and names the stages that it leaves out', () => {
  expect(timeOf(usual)).not.toContain('at most')
  expect(timeOf({ ...usual, seconds_most: null, untimed: ['Attraction'] })).toBe('about 12.0\u202fs without Attraction')
})

it('shows what an earlier run of the same campaign took, and the bound', () => {
  const before = { ...usual, run: 'R-0001' }
  expect(amountOf(before)).toBe('14\u202f515 in R-0001, at most 22\u202f300')
  expect(stageAmountOf({ evaluations: 59, most: 118 }, before.run)).toBe('59, at most 118')
  for (const run of [null, before.run]) expect(stageAmountOf({ evaluations: 0, most: 0 }, run)).toBe('none')
})
