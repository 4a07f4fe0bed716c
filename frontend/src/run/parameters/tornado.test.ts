// The sentence below the tornado chart claims a worse side only where there is one.
import { expect, it } from 'vitest'
import { movedBy } from './Tornado'

it('names the worse side', () => {
  expect(movedBy({ low: -2.5, high: 4 }, 'm')).toBe('has the largest effect: −2.5 m at its worse bound.')
  expect(movedBy({ low: -0.001, high: 4 }, 'm')).toBe('has the largest effect: +4.0 m at one bound, −0.001 m at the other.')
})

it('claims no worse side where both bounds are better than nominal', () => {
  expect(movedBy({ low: 12, high: 23 }, 'm')).toBe('has the largest effect: up to +23 m; neither bound is worse than nominal.')
})
