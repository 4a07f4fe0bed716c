// The sentence below the tornado chart claims a worse side only where there is one.
import { expect, it } from 'vitest'
import { movedBy } from './Tornado'

it('names the worse side', () => {
  expect(movedBy({ low: -2.5, high: 4 }, 'm')).toBe('moves it most: −2.5 m on its worse side.')
})

it('claims no worse side where both bounds are better than nominal', () => {
  expect(movedBy({ low: 12, high: 23 }, 'm')).toBe('moves it most, by up to +23 m; neither of its bounds is worse than nominal.')
})
