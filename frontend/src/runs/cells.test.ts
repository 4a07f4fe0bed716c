import { expect, it } from 'vitest'
import { NONE } from '../format/numbers'
import { amount } from './cells'

const of = (value: number | null, threshold = 1e-9, units = false) => amount(value, { worst_cost: value, threshold, unit: 'm' }, { units })

it('writes every digit of a value that its column has room for, and any other one as a power of ten', () => {
  expect(of(0.9417402, 0.5)).toBe('0.9417')
  expect(of(0.9417402, 0.5, true)).toBe('0.9417 m')
  expect(of(8.257e-6)).toBe('8.257e\u22126')
  expect(of(2.5e8, 1)).toBe('2.5e8')
  expect([of(0), of(0, 1)]).toEqual(['0', '0.000'])
  expect(of(null)).toBe(NONE)
})
