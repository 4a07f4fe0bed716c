// Formats a quantity in a sentence, as `printed` of `campaigns/claims/numbers.py` does.
import type { Quantity } from '../client'
import { count, lowest, MINUS, NARROW, percent, probability, significant } from './numbers'
import { unitText } from './units'

export function quantityText({ value, unit, format, digits }: Pick<Quantity, 'value' | 'unit' | 'format' | 'digits'>): string {
  if (format === 'percent') return percent(value, digits)
  if (isProbability(format)) return probability(value, digits, format)
  const text = format === 'count' ? count(value) : format === 'lowest' ? lowest(value, digits) : significant(value, digits)
  const sign = format === 'signed' && value >= 0 ? '+' : ''
  return `${sign}${text}${unit && NARROW}${unitText(unit)}`
}

/** Digits of a number that is read, not copied; the full precision is shown on hover and is in the files. */
const READ = 4

/**
 * The digits with which each quantity of a sentence is read: four, or more where a whole number or two different numbers of
 * one unit need them. Counts and percentages are written as they are: a bound must not be rounded below itself.
 */
export function readDigits(quantities: readonly Pick<Quantity, 'value' | 'unit' | 'format' | 'digits'>[]): number[] {
  const fewest = quantities.map(({ value, format, digits }) => {
    if (['percent', 'count', 'lowest'].includes(format) || isProbability(format) || value === 0) return digits
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
export function exactText({ value, unit, format }: Pick<Quantity, 'value' | 'unit' | 'format'>): string {
  const percents = format === 'percent' || (isProbability(format) && probability(value).endsWith('%'))
  return `${String(percents ? hundredfold(value) : value).replace('-', MINUS)}${percents ? `${NARROW}%` : unit && NARROW + unitText(unit)}`
}

const isProbability = (format: Quantity['format']) => format === 'probability' || format === 'at_most' || format === 'at_least'

/** 100 times a number by its decimal digits: the product of the binary numbers may end in another digit. */
function hundredfold(value: number): number {
  const [digits = '', exponent = '0'] = String(value).split('e')
  return Number(`${digits}e${Number(exponent) + 2}`)
}
