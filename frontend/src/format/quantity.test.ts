// Quantities as they are read, and with all of their digits.
import { expect, it } from 'vitest'
import type { Quantity } from '../client'
import { exactText, quantityText, readDigits } from './quantity'

const number = (value: number, more: Partial<Quantity> = {}) => ({ value, unit: 'm', format: 'plain' as const, digits: 6, ...more })
const read = (...quantities: ReturnType<typeof number>[]) => {
  const digits = readDigits(quantities)
  return quantities.map((one, i) => quantityText({ ...one, digits: digits[i] ?? 0 }))
}

it('is read with four digits, and has all of them on hover', () => {
  expect(read(number(0.941741), number(0.4417414, { format: 'signed' }))).toEqual(['0.9417 m', '+0.4417 m'])
  expect(exactText(number(-0.941741234567))).toBe('−0.941741234567 m')
  expect(exactText(number(0.0009980790119965865, { unit: '', format: 'percent' }))).toBe('0.09980790119965866 %')
})

it('has as many digits as two different numbers of a sentence need, so that none reads like the criterion', () => {
  expect(read(number(0.9), number(0.89996))).toEqual(['0.9 m', '0.89996 m'])
  expect(read(number(0.9), number(0.89996, { unit: 's' }))).toEqual(['0.9 m', '0.9 s'])
  expect(read(number(0.5), number(0.5))).toEqual(['0.5 m', '0.5 m'])
})

it('never rounds a whole number, a count or a bound in percent', () => {
  expect(read(number(15125), number(40314, { format: 'count', unit: '' }), number(0.00099808, { format: 'percent', unit: '', digits: 3 }))).toEqual([
    '15125 m', '40 314', '0.0998 %',
  ])
  expect(read(number(0), number(Number.MIN_VALUE), number(1e300))).toHaveLength(3)
})
