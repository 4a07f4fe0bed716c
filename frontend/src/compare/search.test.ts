// The order of compared runs.
import { expect, it } from 'vitest'
import { idsOf, olderFirst, withRun } from './search'

it('begins with the oldest run, by number and not by text', () => {
  expect(olderFirst(['R-0010', 'R-0002', 'R-10000', 'R-9999'])).toEqual(['R-0002', 'R-0010', 'R-9999', 'R-10000'])
})

it('puts an added run where it belongs, and behind the others once they were swapped', () => {
  expect(withRun(['R-0007'], 'R-0003')).toEqual(['R-0003', 'R-0007'])
  expect(withRun([], 'R-0003')).toEqual(['R-0003'])
  expect(withRun(['R-0007', 'R-0003'], 'R-0005')).toEqual(['R-0007', 'R-0003', 'R-0005'])
})

it('keeps the order of an address, which a swap is stored in', () => {
  expect(idsOf('R-0007,R-0003,R-0007,no')).toEqual(['R-0007', 'R-0003'])
})
