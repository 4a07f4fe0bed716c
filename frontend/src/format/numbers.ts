// Formats all numbers: true minus sign, narrow space between thousands, a dot for decimals, percent after a narrow space.
// The same texts as `campaigns/claims/numbers.py`, by the cases of `frontend/tests/numbers.json`. Start reading at `fixed`.

export const MINUS = '\u2212'
export const NARROW = '\u202f'
export const NONE = '\u2014'
/** A number of more characters does not fit next to an axis. */
export const LONG = 9

type Maybe = number | null | undefined

function known(value: Maybe): value is number {
  return value !== null && value !== undefined && Number.isFinite(value)
}

function grouped(digits: string): string {
  const [whole = '', fraction] = digits.split('.')
  const spaced = whole.length > 3 ? whole.replace(/\B(?=(\d{3})+$)/g, NARROW) : whole
  return fraction === undefined ? spaced : `${spaced}.${fraction}`
}

/** A number with fixed decimals; a dash if it is missing. */
export function fixed(value: Maybe, decimals = 2): string {
  if (!known(value)) return NONE
  const text = decimal(Math.abs(value), Math.min(Math.max(decimals, 0), 20))
  const negative = value < 0 && Number(text) !== 0
  return (negative ? MINUS : '') + grouped(text)
}

/** As `fixed`, with a plus before positive numbers: margins and differences. */
export function signed(value: Maybe, decimals = 2): string {
  const text = fixed(value, decimals)
  return known(value) && value > 0 && /[1-9]/.test(text) ? `+${text}` : text
}

/** As `signed`, but never zero for a margin that is not: its sign is what counts. */
export function margin(value: Maybe, decimals = 2): string {
  const text = signed(value, decimals)
  if (!known(value) || value === 0 || /[1-9]/.test(text)) return text
  return `${value > 0 ? '+' : ''}${plain(value, 2)}`
}

/** A whole number. */
export const count = (value: Maybe): string => fixed(value, 0)

/** A sentence of the service, whose numbers have commas for terminals, with numbers as the pages write them. */
export const thinned = (sentence: string): string => sentence.replace(/(?<=\d),(?=\d{3}(?!\d))/g, NARROW)

/** Decimals that show the largest of the numbers with the given significant digits. */
export function decimalsFor(values: readonly Maybe[], digits = 4): number {
  const largest = Math.max(0, ...values.filter(known).map(Math.abs))
  if (largest === 0) return Math.max(0, digits - 1)
  return Math.min(12, Math.max(0, digits - 1 - Math.floor(Math.log10(largest) + 1e-12)))
}

/** Decimals, at least so many, that show each value on its own side of the threshold. */
export function decimalsBeside(values: readonly Maybe[], threshold: Maybe, least = decimalsFor([...values, threshold])): number {
  if (!known(threshold)) return least
  const side = (value: number): number => Math.sign(value - threshold)
  const needed = (value: number): number => {
    for (let n = least; n <= 20; n++) if (side(Math.sign(value) * Number(decimal(Math.abs(value), n))) === side(value)) return n
    return least
  }
  return Math.max(least, ...values.filter(known).map(needed))
}

/** Decimals that distinguish the two closest numbers, at most `most` significant digits. */
export function decimalsApart(values: readonly Maybe[], digits = 4, most = 7): number {
  const sorted = values.filter(known).sort((a, b) => a - b)
  const gaps = sorted.slice(1).map((v, i) => v - (sorted[i] as number))
  const scale = Math.max(...sorted.map(Math.abs), 0)
  const real = gaps.filter((gap) => gap > 1e-9 * scale)
  const base = decimalsFor(sorted, digits)
  if (real.length === 0) return base
  const apart = Math.ceil(-Math.log10(Math.min(...real)) - 0.01)
  return Math.min(Math.max(base, apart), decimalsFor(sorted, most))
}

/** A number with significant digits, without trailing zeros; powers of ten for very large and small ones. */
export function plain(value: Maybe, digits = 6): string {
  if (!known(value)) return NONE
  if (value === 0) return '0'
  const size = Math.abs(value)
  if (size >= 1e9 || size < 1e-4) return powered(value, digits)
  const power = Number(exponential(size, digits).split('e')[1]) // of the rounded number: 0.9999996 may be 1
  return (value < 0 ? MINUS : '') + trimmed(fixed(size, digits - 1 - power))
}

/**
 * The significant digits, at least so many, with which bounds claim no wider interval than they are: low is written no lower and
 * high no higher, but for rounding of the last bits, and the interval no narrower by more than 1e-9 of it.
 */
export function digitsBetween(low: number, high: number, least = 6): number {
  const bits = 4 * ulp(Math.max(Math.abs(low), Math.abs(high)))
  const inside = Math.max(1e-9 * (high - low), bits)
  const written = (value: number, digits: number) => Math.sign(value) * Number(exponential(Math.abs(value), digits))
  const fits = (by: number) => by >= -bits && by <= inside
  for (let n = least; n < 17; n++) if (fits(written(low, n) - low) && fits(high - written(high, n))) return n
  return 17
}

/** The distance from a size to the next larger number. */
function ulp(size: number): number {
  const power = new DataView(Float64Array.of(size).buffer).getUint16(6, true) >> 4
  return power === 0 ? Number.MIN_VALUE : 2 ** (power - 1075)
}

/** As `plain`, with all digits of a threshold or a setting: nothing is compared with what it is not. */
export function exact(value: Maybe): string {
  if (!known(value)) return NONE
  const text = String(Math.abs(value))
  if (value !== 0 && !text.includes('e') && Math.abs(value) >= 1e-4 && Math.abs(value) < 1e9) return fixed(value, text.split('.')[1]?.length ?? 0)
  let digits = 6
  while (digits < 17 && Number(value.toPrecision(digits)) !== value) digits++
  return plain(value, digits)
}

/** A number as a power of ten with significant digits, without trailing zeros. */
export function powered(value: number, digits: number): string {
  if (value === 0) return '0'
  const [mantissa = '', exponent = '0'] = exponential(Math.abs(value), digits).split('e')
  const power = Number(exponent)
  return `${value < 0 ? MINUS : ''}${trimmed(mantissa)}e${power < 0 ? MINUS : ''}${Math.abs(power)}`
}

/** As `fixed`, but as a power of ten if that would be longer than nine characters. */
export function short(value: Maybe, decimals = 2): string {
  const text = fixed(value, decimals)
  if (!known(value) || text.length <= LONG) return text
  const brief = plain(value, 4)
  return brief.length > LONG ? powered(value, 4) : brief
}

/** Without trailing zeros after the dot. */
export function trimmed(digits: string): string {
  return digits.includes('.') ? digits.replace(/\.?0*$/, '') : digits
}

/** The text of a number field: full precision, no grouping, so that it parses to the stored value. */
export function field(value: number): string {
  return String(value).replace('-', MINUS)
}

/**
 * Parses a field's text; null if it is not a number. Accepts both minus signs, spaces between thousands, a comma for decimals;
 * 20,000 is ambiguous.
 */
export function parse(text: string): number | null {
  if (/^\s*[+-]?[1-9]\d{0,2},\d{3}\s*$/.test(text.replaceAll(MINUS, '-'))) return null
  const clean = text
    .trim()
    .replaceAll(MINUS, '-')
    .replace(/[\s\u202f\u2009']/g, '')
    .replace(',', '.')
  if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(clean)) return null
  const value = Number(clean)
  return Number.isFinite(value) ? value : null
}

/** A fraction from here on is read as all: the sum of shares may be 1 but for rounding. */
const ALL = 1 - 1e-12

/** A fraction as percent. */
export function percent(share: Maybe, digits = 3): string {
  if (!known(share)) return NONE
  let text = significant(100 * share, digits)
  // As many digits as tell less than all from all.
  for (let more = digits + 1; share < ALL && Number(text) === 100 && more < 18; more++) text = significant(100 * share, more)
  const size = Number(text.replace(MINUS, '-'))
  if (text.includes('e+') && Math.abs(size) < 10_000) text = String(size).replace('-', MINUS)
  return `${text}${NARROW}%`
}

/** How a probability is rounded: to the nearest, up as an upper bound, down as a lower one. */
type Rounded = 'probability' | 'at_most' | 'at_least'

/**
 * A probability: as percent, below 0.01 % as a power of ten. Rounded once, by the digits of the shortest decimal number that is
 * it; no bound, with as many digits as tell less than all from all.
 */
export function probability(value: Maybe, digits = 3, rounded: Rounded = 'probability'): string {
  if (!known(value)) return NONE
  if (value === 0) return `0${NARROW}%`
  const [mantissa = '', exponent = '0'] = Math.abs(value).toExponential().split('e')
  const all = mantissa.replace('.', '')
  const rest = all.slice(digits)
  const odd = Number(all[digits - 1]) % 2 === 1
  const away = rounded === 'probability' ? rest > '5' || (rest === '5' && odd) : rest !== '' && (rounded === 'at_most') === value > 0
  const kept = String(BigInt(all.slice(0, digits)) + (away ? 1n : 0n))
  const power = Number(exponent) + (kept.length > Math.min(all.length, digits) ? 1 : 0)
  if (rounded === 'probability' && exponent === '-1' && power === 0 && Math.abs(value) < ALL) return probability(value, digits + 1)
  const minus = value < 0 ? MINUS : ''
  if (power >= -4) return `${minus}${trimmed(positioned(kept, power + 2))}${NARROW}%`
  return `${minus}${kept[0]}.${kept.slice(1).replace(/0+$/, '') || '0'}e${MINUS}${-power}`
}

/** An upper bound on a probability, never written below itself. */
export const atMost = (bound: Maybe, digits = 3): string => probability(bound, digits, 'at_most')

/** A lower bound on a probability, never written above itself. */
export const atLeast = (bound: Maybe, digits = 3): string => probability(bound, digits, 'at_least')

/** A probability that a bound is compared with, with all its digits: no higher bound reads the same. */
export const goal = (target: Maybe): string => probability(target, 17)

/** The confidence of a bound or an interval, as in a sentence: never written above itself. */
export const confidenceText = (fraction: Maybe): string => atLeast(fraction, 6)

/** Digits with the decimal point after that of this power of ten. */
function positioned(digits: string, power: number): string {
  if (power < 0) return `0.${'0'.repeat(-power - 1)}${digits}`
  const whole = digits.padEnd(power + 1, '0')
  return whole.length > power + 1 ? `${whole.slice(0, power + 1)}.${whole.slice(power + 1)}` : whole
}

/** Significant digits of a lower bound, rounded down by the digits of the shortest decimal number that is it. */
export function lowest(value: number, digits: number): string {
  const [mantissa = '', exponent = '0'] = Math.abs(value).toExponential().split('e')
  const all = mantissa.replace('.', '')
  const more = value < 0 && all.length > digits ? 1n : 0n
  const kept = `${BigInt(all.slice(0, digits)) + more}e${Number(exponent) - Math.min(all.length, digits) + 1}`
  return significant(value < 0 ? -Number(kept) : Number(kept), digits)
}

/** A value with half the width of its interval, which holds the whole interval as it is read. */
export function spread(value: Maybe, half: Maybe): string {
  if (!known(value)) return NONE
  const shown = plain(value, 3)
  if (!known(half)) return `${shown} ± ${NONE}`
  const apart = Math.abs(value - (parse(shown) ?? value))
  return `${shown} ± ${plain(-(parse(lowest(-half - apart, 2)) ?? NaN), 2)}`
}

/** Significant digits without trailing zeros; powers of ten below 1e-4 and above the range of the digits. */
export function significant(value: number, digits: number): string {
  if (value === 0) return '0'
  const [mantissa = '', exponent = '0'] = exponential(Math.abs(value), digits).split('e')
  const power = Number(exponent)
  const minus = value < 0 ? MINUS : ''
  if (power < -4 || power >= digits) {
    const size = String(Math.abs(power)).padStart(2, '0')
    return `${minus}${trimmed(mantissa)}e${power < 0 ? MINUS : '+'}${size}`
  }
  return minus + trimmed(positioned(mantissa.replace('.', ''), power))
}

/** A duration [s]: 23.4 s, 1:25 min, 2 h 01 min; rounded once, as the service does. */
export function duration(seconds: Maybe): string {
  if (!known(seconds)) return NONE
  const tenths = decimal(Math.max(0, seconds), 1)
  if (Number(tenths) < 60) return `${Number(tenths) === 0 ? `<${NARROW}0.1` : tenths}${NARROW}s`
  const parts = (whole: number) => [Math.floor(whole / 60), String(whole % 60).padStart(2, '0')] as const
  const [minutes, rest] = parts(Number(decimal(seconds, 0)))
  if (minutes < 60) return `${minutes}:${rest}${NARROW}min`
  const [hours, left] = parts(Number(decimal(seconds / 60, 0)))
  return `${hours}${NARROW}h${NARROW}${left}${NARROW}min`
}

/** Digits in which a tie of two roundings ends, and so is distinguished from a number next to it. */
const EXACT = 100

/**
 * A size with fixed decimals. A tie goes to the even digit, as in the service: JavaScript rounds ties up, so that 0.125 m
 * would be 0.13 in a table and 0.12 in a sentence.
 */
function decimal(size: number, decimals: number): string {
  // From here on JavaScript writes powers of ten; these numbers are whole.
  if (size >= 1e21) return BigInt(size).toString() + (decimals > 0 ? `.${'0'.repeat(decimals)}` : '')
  const nearest = size.toFixed(decimals)
  if (!Number.isInteger(2 * size * 10 ** decimals)) return nearest
  const exact = size.toFixed(EXACT)
  const end = exact.indexOf('.') + 1 + decimals
  const below = exact.slice(0, decimals > 0 ? end : end - 1)
  return /^50*$/.test(exact.slice(end)) && Number(below.at(-1)) % 2 === 0 ? below : nearest
}

/** A size as a power of ten, with significant digits; ties as above. */
function exponential(size: number, digits: number): string {
  const [exact = '', exponent = ''] = size.toExponential(EXACT).split('e')
  const all = exact.replace('.', '')
  const tie = /^50*$/.test(all.slice(digits)) && Number(all[digits - 1]) % 2 === 0
  if (!tie) return size.toExponential(digits - 1)
  return `${all[0]}${digits > 1 ? '.' : ''}${all.slice(1, digits)}e${exponent}`
}
