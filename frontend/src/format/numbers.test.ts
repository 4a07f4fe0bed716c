// What numbers look like on the pages.
import { describe, expect, it } from 'vitest'
import { count, decimalsApart, decimalsFor, duration, field, fixed, parse, percent, plain, signed, thinned } from './numbers'

it('writes the numbers of a sentence as the pages do', () => {
  expect(thinned('ends after 1,128,880 at the latest, in 2025, 60 min')).toBe('ends after 1\u202f128\u202f880 at the latest, in 2025, 60 min')
})

describe('fixed', () => {
  it('uses a true minus and narrow spaces', () => {
    expect(fixed(-1234567.891, 1)).toBe('\u22121\u202f234\u202f567.9')
    expect(count(40314)).toBe('40\u202f314')
    expect(count(999)).toBe('999')
  })
  it('has no negative zero and a dash for nothing', () => {
    expect(fixed(-0.001, 2)).toBe('0.00')
    expect(fixed(null)).toBe('\u2014')
    expect(fixed(Number.NaN)).toBe('\u2014')
  })
  it('signs margins', () => {
    expect(signed(7.194)).toBe('+7.19')
    expect(signed(-5.12)).toBe('\u22125.12')
    expect(signed(0.0001)).toBe('0.00')
  })
})

describe('decimals', () => {
  it('shows four significant digits of the largest', () => {
    expect(decimalsFor([0.9417])).toBe(4)
    expect(decimalsFor([57.19, 0.1])).toBe(2)
    expect(decimalsFor([1000])).toBe(0)
    expect(decimalsFor([0, null])).toBe(3)
  })
  it('distinguishes close values', () => {
    expect(decimalsApart([57.185, 57.186, 59.4])).toBe(3)
    expect(decimalsApart([0.94174, 0.94356])).toBe(4)
    expect(decimalsApart([1, 1 + 1e-8])).toBe(6)
  })
})

describe('plain', () => {
  it('drops trailing zeros', () => {
    expect(plain(0.05)).toBe('0.05')
    expect(plain(-2)).toBe('\u22122')
    expect(plain(12000.5)).toBe('12\u202f000.5')
    expect(plain(1e-6)).toBe('1e\u22126')
    expect(plain(200)).toBe('200')
  })
})

describe('fields', () => {
  it('reads what it writes', () => {
    for (const value of [0, -1.5, 1e-7, 123456.789, 5.940000000000001]) expect(parse(field(value))).toBe(value)
  })
  it('refuses what is not a number', () => {
    for (const text of ['', 'abc', '1e', '1 m', '--1', 'NaN']) expect(parse(text)).toBeNull()
    expect(parse('1 000,5')).toBe(1000.5)
  })
})

import { unitText } from './units'

it('sets units', () => {
  expect(unitText('kg m2')).toBe('kg·m²')
  expect(unitText('N s2/m')).toBe('N·s²/m')
  expect(unitText('m/(s N)')).toBe('m/(s·N)')
  expect(unitText('')).toBe('')
})

describe('words', () => {
  it('percent and duration', () => {
    expect(percent(0.0006)).toBe('0.060\u202f%')
    expect(percent(0.1)).toBe('10\u202f%')
    expect(duration(23)).toBe('23.0\u202fs')
    expect(duration(85)).toBe('1:25\u202fmin')
    expect(duration(7260)).toBe('2\u202fh\u202f01\u202fmin')
  })
})
