import { expect, it } from 'vitest'
import { whereOf } from './where'

it('names the evaluation of a method only for the value that this evaluation has', () => {
  const stage = { best: 2.5e-5, best_index: 17 }
  expect(whereOf(stage, 2.5e-5)).toBe(', evaluation 18')
  expect(whereOf(stage, 1e-5)).toBe(', refined in validation')
  expect(whereOf(stage, 3e-5)).toBe('')
  expect(whereOf({ best: null, best_index: null }, 1e-5)).toBe('')
  expect(whereOf(undefined, null)).toBe('')
})
