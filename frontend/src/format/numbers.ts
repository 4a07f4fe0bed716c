// Formats all numbers: true minus sign, narrow space between thousands, a dot for decimals,
// percent after a narrow space.

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
  const text = Math.abs(value).toFixed(Math.min(Math.max(decimals, 0), 20))
  const negative = value < 0 && Number(text) !== 0
  return (negative ? MINUS : '') + grouped(text)
}

/** As `fixed`, with a plus before positive numbers: margins and differences. */
export function signed(value: Maybe, decimals = 2): string {
  const text = fixed(value, decimals)
  return known(value) && value > 0 && /[1-9]/.test(text) ? `+${text}` : text
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
  return (value < 0 ? MINUS : '') + grouped(trimmed(size.toFixed(decimalsFor([size], digits))))
}

/** A number as a power of ten with significant digits, without trailing zeros. */
export function powered(value: number, digits: number): string {
  if (value === 0) return '0'
  const [mantissa = '', exponent = '0'] = Math.abs(value).toExponential(digits - 1).split('e')
  const power = Number(exponent)
  return `${value < 0 ? MINUS : ''}${trimmed(mantissa)}e${power < 0 ? MINUS : ''}${Math.abs(power)}`
}

/** As `fixed`, but as a power of ten if that would be longer than nine characters. */
export function short(value: Maybe, decimals = 2): string {
  const text = fixed(value, decimals)
  return known(value) && text.length > LONG ? plain(value, 4) : text
}

/** Without trailing zeros after the dot. */
export function trimmed(digits: string): string {
  return digits.includes('.') ? digits.replace(/\.?0*$/, '') : digits
}

/** The text of a number field: full precision, no grouping, so that it parses to the stored value. */
export function field(value: number): string {
  return String(value).replace('-', MINUS)
}

/** Parses a field's text; null if it is not a number. Accepts both minus signs, spaces between thousands. */
export function parse(text: string): number | null {
  const clean = text
    .trim()
    .replaceAll(MINUS, '-')
    .replace(/[\s\u202f\u2009']/g, '')
    .replace(',', '.')
  if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(clean)) return null
  const value = Number(clean)
  return Number.isFinite(value) ? value : null
}

/** A fraction as percent. */
export function percent(share: Maybe, digits = 2): string {
  if (!known(share)) return NONE
  const value = share * 100
  return `${fixed(value, value === 0 ? 0 : decimalsFor([value], digits))}${NARROW}%`
}

/** A duration [s], short enough for a table. */
export function duration(seconds: Maybe): string {
  if (!known(seconds)) return NONE
  if (seconds < 0.095) return `<${NARROW}0.1${NARROW}s`
  if (seconds < 60) return `${seconds.toFixed(1)}${NARROW}s`
  const whole = Math.round(seconds)
  if (whole < 3600) return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}${NARROW}min`
  const minutes = Math.round(whole / 60)
  return `${Math.floor(minutes / 60)}${NARROW}h${NARROW}${String(minutes % 60).padStart(2, '0')}${NARROW}min`
}
