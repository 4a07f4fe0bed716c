// The values of a sweep as typed: numbers separated by commas, semicolons or spaces.
import type { ParameterEntry } from '../../client'
import { MINUS, parse } from '../../format/numbers'

/** As the service allows. */
export const MOST = 50

type Limits = Pick<ParameterEntry, 'low' | 'high' | 'unit'>

/** "0,5" between spaces or semicolons: one number with a decimal comma, or two: ambiguous. */
const UNCLEAR = /^[+-]?\d+,\d+(e[+-]?\d+)?,?$/i

/**
 * The words of a list separated by commas, semicolons or spaces. What may be a decimal comma is not split, and
 * is not a number: it still has its comma.
 */
const numbersIn = (text: string): string[] =>
  text
    .split(/[;\s]+/)
    .flatMap((word) => (UNCLEAR.test(word.replaceAll(MINUS, '-')) ? word.replace(/,$/, '') : word.split(',')))
    .filter(Boolean)

/** The values, or why the text cannot be used; an empty reason for an empty text. */
export function valuesOf(text: string, limits: Limits | undefined): { values: number[] } | { problem: string } {
  const words = numbersIn(text)
  if (words.length === 0) return { problem: '' }
  const values: number[] = []
  for (const word of words) {
    if (word.includes(','))
      return { problem: `“${word}” may be one number or two; give values such as 0.5, 1, 2, with a space after each comma.` }
    const value = parse(word)
    if (value === null) return { problem: `“${word}” is not a number; give values such as 0.5, 1, 2.` }
    if (limits && (value < limits.low || value > limits.high))
      return { problem: `${word} is outside ${limits.low} to ${limits.high} ${limits.unit}`.trim() + '.' }
    if (values.includes(value)) return { problem: `${word} is given twice.` }
    values.push(value)
  }
  if (values.length < 2) return { problem: 'Give at least two values.' }
  if (values.length > MOST) return { problem: `${values.length} values, at most ${MOST} are allowed.` }
  return { values }
}
