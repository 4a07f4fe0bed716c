// What numbers look like on the pages.
import { describe, expect, it } from 'vitest'
import cases from '../../tests/numbers.json'
import type { Quantity } from '../client'
import { confidenceText, count, decimalsApart, decimalsBeside, decimalsFor, digitsBetween, duration, exact, field, fixed, goal, margin, parse, percent, plain, signed, spread, thinned } from './numbers'
import { quantityText } from './quantity'
import { unitText } from './units'

it('writes the numbers of a sentence as the pages do', () => {
  expect(thinned('ends after 1,128,880 at the latest, in 2025, 60 min')).toBe('ends after 1\u202f128\u202f880 at the latest, in 2025, 60 min')
})

const WRITTEN: Record<string, (...values: never[]) => string | number> = {
  printed: (value: number, unit: string, format: Quantity['format'], digits: number) => quantityText({ value, unit, format, digits }),
  fixed,
  signed,
  margin,
  count,
  plain,
  duration,
  unit: unitText,
  decimals_for: decimalsFor,
  decimals_apart: decimalsApart,
  decimals_beside: decimalsBeside,
  digits_between: digitsBetween,
}

it.each(Object.keys(WRITTEN))('writes every case as the service does: %s', (name) => {
  expect(Object.keys(cases).sort()).toEqual(Object.keys(WRITTEN).sort())
  const rows = (cases as unknown as Record<string, unknown[][]>)[name] ?? []
  expect(rows.map((row) => WRITTEN[name]?.(...(row.slice(0, -1) as never[])))).toEqual(rows.map((row) => row.at(-1)))
})

it.each([
  [[0.50000004, 1.2], 0.5, '0.50000004'],
  [[0.49999996, 1.2], 0.5, '0.49999996'],
  [[0.5, 1.2], 0.5, '0.500'],
  [[0.3, null], null, '0.3000'],
])('shows a value on its own side of the threshold: %s', (values, threshold, text) => {
  expect(fixed(values[0], decimalsBeside(values, threshold))).toBe(text)
})

describe('fields', () => {
  it('reads what it writes', () => {
    for (const value of [0, -1.5, 1e-7, 123456.789, 5.940000000000001]) expect(parse(field(value))).toBe(value)
  })
  it('refuses what is not a number', () => {
    for (const text of ['', 'abc', '1e', '1 m', '--1', 'NaN', '20,000', '-1,000']) expect(parse(text)).toBeNull()
    expect(parse('1 000,5')).toBe(1000.5)
    expect(parse('0,125')).toBe(0.125)
  })
})

it('writes a fraction with the digits of a sentence', () => {
  expect([0.0006, 0.1, 0.0004994, 0, null].map((fraction) => percent(fraction))).toEqual([
    '0.06\u202f%', '10\u202f%', '0.0499\u202f%', '0\u202f%', '\u2014',
  ])
})

it('writes a threshold in full', () => {
  const written = [0.5, 0.1, 1.00000005, 123456.6, 0.9999996, -4.5, 1e-7].map((value) => exact(value))
  expect(written).toEqual(['0.5', '0.1', '1.00000005', '123\u202f456.6', '0.9999996', '\u22124.5', '1e\u22127'])
})

it('writes a confidence no higher than the sentences of the service do', () => {
  expect([0.95, 0.9545, 0.9973, 0.99865, 0.9496, 0.9499995, 0.9999999].map(confidenceText)).toEqual(
    ['95', '95.45', '99.73', '99.865', '94.96', '94.9999', '99.9999'].map((text) => `${text}\u202f%`),
  )
})

it('writes a target with all its digits, so that no higher bound reads the same', () => {
  expect([0.05, 0.0123449999, 1e-6, 0.01239999].map(goal)).toEqual(['5\u202f%', '1.23449999\u202f%', '1.0e\u22126', '1.239999\u202f%'])
})

it('writes an interval that holds the one that it is of', () => {
  const read = (text: string) => text.split(' ± ').map((part) => parse(part) ?? NaN)
  for (let k = 0; k < 2000; k++) {
    const [value, half] = [Math.sin(k) * 10 ** (k % 5 - 3), Math.abs(Math.cos(k)) * 10 ** (k % 4 - 3)]
    const [middle = NaN, apart = NaN] = read(spread(value, half))
    expect(middle - apart).toBeLessThanOrEqual(value - half + 1e-15)
    expect(middle + apart).toBeGreaterThanOrEqual(value + half - 1e-15)
  }
  expect([spread(0.5, null), spread(null, 0.1), spread(0.314, 0.045)]).toEqual(['0.5 ± \u2014', '\u2014', '0.314 ± 0.045'])
})
