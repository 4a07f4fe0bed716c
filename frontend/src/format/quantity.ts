// Formats a quantity in a sentence with the same digits as the service (`campaigns/claims/numbers.py`); a test compares
// both.
import type { Quantity } from '../client'
import { count, MINUS, NARROW, trimmed } from './numbers'
import { unitText } from './units'

export function quantityText({ value, unit, format, digits }: Pick<Quantity, 'value' | 'unit' | 'format' | 'digits'>): string {
  if (format === 'percent') return `${significant(100 * value, digits)}${NARROW}%`
  const text = format === 'count' ? count(value) : significant(value, digits)
  const sign = format === 'signed' && value >= 0 ? '+' : ''
  return `${sign}${text}${unit && NARROW}${unitText(unit)}`
}

/** Significant digits without trailing zeros; powers of ten below 1e-4 and above the range of the digits. */
function significant(value: number, digits: number): string {
  if (value === 0) return '0'
  const [mantissa = '', exponent = '0'] = rounded(Math.abs(value), digits).split('e')
  const power = Number(exponent)
  const minus = value < 0 ? MINUS : ''
  if (power < -4 || power >= digits) {
    const size = String(Math.abs(power)).padStart(2, '0')
    return `${minus}${trimmed(mantissa)}e${power < 0 ? MINUS : '+'}${size}`
  }
  const plain = mantissa.replace('.', '')
  const written = power < 0 ? `0.${'0'.repeat(-power - 1)}${plain}` : `${plain.slice(0, power + 1)}.${plain.slice(power + 1)}`
  return minus + trimmed(written)
}

const EXACT = 60
/** In powers of ten; rounds half to even, as the service does. */
function rounded(size: number, digits: number): string {
  const [exact = '', exponent = ''] = size.toExponential(EXACT).split('e')
  const all = exact.replace('.', '')
  const tie = /^50*$/.test(all.slice(digits)) && Number(all[digits - 1]) % 2 === 0
  return tie ? `${all[0]}.${all.slice(1, digits)}e${exponent}` : size.toExponential(digits - 1)
}

/** Digits of a number that is read, not copied; the full precision is shown on hover and is in the files. */
const READ = 4

/**
 * The digits with which each quantity of a sentence is read: four, or more where a whole number or two different numbers of
 * one unit need them. Counts and percentages are written as they are: a bound must not be rounded below itself.
 */
export function readDigits(quantities: readonly Pick<Quantity, 'value' | 'unit' | 'format' | 'digits'>[]): number[] {
  const fewest = quantities.map(({ value, format, digits }) => {
    if (format === 'percent' || format === 'count' || value === 0) return digits
    return Math.min(digits, Math.max(READ, Math.floor(Math.log10(Math.abs(value))) + 1))
  })
  return quantities.map((one, i) => {
    const same = (digits: number) =>
      quantities.some((other) => {
        if (other.unit !== one.unit || other.format !== one.format || other.value === one.value) return false
        return quantityText({ ...one, digits }) === quantityText({ ...other, digits: Math.min(other.digits, digits) })
      })
    let digits = fewest[i] ?? one.digits
    while (digits < one.digits && same(digits)) digits++
    return digits
  })
}

/** All digits of a quantity, as stored. */
export const exactText = ({ value, unit, format }: Pick<Quantity, 'value' | 'unit' | 'format'>): string =>
  `${String(format === 'percent' ? hundredfold(value) : value).replace('-', MINUS)}${format === 'percent' ? `${NARROW}%` : unit && NARROW + unitText(unit)}`

/** 100 times a number by its decimal digits: the product of the binary numbers may end in another digit. */
function hundredfold(value: number): number {
  const [digits = '', exponent = '0'] = String(value).split('e')
  return Number(`${digits}e${Number(exponent) + 2}`)
}
