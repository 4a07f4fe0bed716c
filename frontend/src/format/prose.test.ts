// Sentences of the service as in print.
import { expect, it } from 'vitest'
import { pieces, typeset } from './prose'

const TERMS = [
  { written: 'd_min', symbol: 'd_min' },
  { written: 'vehicle.m', symbol: 'm' },
  { written: 'vehicle.mass', symbol: 'M' },
]

it('finds terms, the longest first, and nothing within other words', () => {
  expect(pieces('vehicle.mass 4 to 6 kg, d_min. vehicle.m.x d_minimum', TERMS)).toEqual([
    TERMS[2],
    { text: ' 4 to 6 kg, ' },
    TERMS[0],
    { text: '. vehicle.m.x d_minimum' },
  ])
  expect(pieces('nothing', [])).toEqual([{ text: 'nothing' }])
})

it('sets minus signs and units', () => {
  expect(typeset('-1.356 to -0.904 1/rad, 3e-07, half-step 2-3', ['1/rad'])).toBe(
    '\u22121.356 to \u22120.904\u202f1/rad, 3e\u221207, half-step 2-3',
  )
  expect(typeset('at most 5 % of', [])).toBe('at most 5\u202f% of')
  expect(typeset('0.04 to 0.06 kg m2; 5 men, 5 m', ['m', 'kg m2'])).toBe('0.04 to 0.06\u202fkg·m²; 5 men, 5\u202fm')
})
