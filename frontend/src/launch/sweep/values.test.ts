// The values of a sweep as typed.
import { expect, it } from 'vitest'
import { MOST, valuesOf } from './values'

const limits = { low: 0, high: 10, unit: 'm' }
const problem = (text: string) => {
  const found = valuesOf(text, limits)
  return 'problem' in found ? found.problem : null
}

it('reads numbers with any separator', () => {
  for (const text of ['0.5,1, 2', '0.5 1 2', ' 0.5;1 ;2, ']) expect(valuesOf(text, limits)).toEqual({ values: [0.5, 1, 2] })
  expect(valuesOf('-1, −2, 1e3', undefined)).toEqual({ values: [-1, -2, 1000] })
})

it('tells a decimal comma, which it does not split into two values', () => {
  for (const text of ['0,5', '0,5 1', '0,5; 1,5', '0,5, 1,5', '−0,5 1']) expect(problem(text)).toContain('may be one number or two')
  expect(valuesOf('0,1,2', limits)).toEqual({ values: [0, 1, 2] })
  expect(valuesOf('0.5,1', limits)).toEqual({ values: [0.5, 1] })
})

it('says what is wrong', () => {
  expect(problem('')).toBe('')
  expect(problem(' ,; ')).toBe('')
  expect(problem('1')).toContain('at least two')
  expect(problem('1, 1.0')).toBe('1.0 is given twice.')
  expect(problem('1, much')).toContain('“much” is not a number')
  expect(problem('1, NaN')).toContain('not a number')
  expect(problem('1, 11')).toBe('11 is outside 0 to 10 m.')
  expect(problem(Array.from({ length: MOST + 1 }, (_, i) => i / 100).join(' '))).toContain('at most 50')
})
