// Axis ticks and their labels, and ranges that contain given values.
import { fixed, LONG, NARROW, powered } from '../format/numbers'

/** Round numbers within a range, about the given count. */
export function linearTicks(low: number, high: number, about: number): number[] {
  if (!(high > low) || about < 1) return [low]
  const raw = (high - low) / about
  const power = 10 ** Math.floor(Math.log10(raw))
  const step = ([1, 2, 2.5, 5, 10].find((m) => m * power >= raw * 0.999) ?? 10) * power
  const first = Math.ceil(low / step - 1e-9)
  const last = Math.floor(high / step + 1e-9)
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(12)))
}

/** Powers of ten within a range; also 2 and 5 times these if there are fewer than three. */
export function logTicks(low: number, high: number): number[] {
  if (!(low > 0) || !(high > low)) return [low]
  const ticks = (factors: number[]): number[] => {
    const found: number[] = []
    for (let power = Math.floor(Math.log10(low)) - 1; power <= Math.ceil(Math.log10(high)); power++)
      for (const factor of factors) {
        const tick = Number((factor * 10 ** power).toPrecision(12))
        if (tick >= low * (1 - 1e-9) && tick <= high * (1 + 1e-9)) found.push(tick)
      }
    return found
  }
  const decades = ticks([1])
  if (decades.length >= 3) return decades
  const finer = ticks([1, 2, 5])
  return finer.length >= 3 ? finer : linearTicks(low, high, 4)
}

/** Number of decimals needed to distinguish adjacent ticks. */
export function tickDecimals(ticks: readonly number[]): number {
  const least = leastGap(ticks)
  if (!Number.isFinite(least)) return ticks.length === 1 && ticks[0] !== 0 ? significantDecimals(ticks[0] as number) : 0
  return decimalsOf(least, 0)
}

/** The smallest distance between adjacent ticks; infinite for a single one. */
const leastGap = (ticks: readonly number[]): number =>
  Math.min(...ticks.slice(1).map((tick, i) => Math.abs(tick - (ticks[i] as number))).filter((gap) => gap > 0))

/** The decimals of a distance between ticks, no fewer than `fewest`. */
function decimalsOf(gap: number, fewest: number): number {
  const decimals = Math.max(fewest, -Math.floor(Math.log10(gap) + 1e-9))
  const scaled = gap * 10 ** decimals
  return Math.abs(scaled - Math.round(scaled)) > 1e-6 ? decimals + 1 : decimals
}

/** The labels of an axis: with as many decimals as distinguish them, or as powers of ten where that is shorter. */
export function tickText(ticks: readonly number[]): (tick: number) => string {
  const decimals = tickDecimals(ticks)
  const longest = (text: (tick: number) => string) => Math.max(0, ...ticks.map((tick) => text(tick).length))
  const inFull = (tick: number) => fixed(tick, decimals)
  if (longest(inFull) <= LONG) return inFull
  const size = Math.max(...ticks.map(Math.abs))
  const digits = Math.min(12, Math.max(1, Math.floor(Math.log10(size) + 1e-9) + 1 + decimalsApart(ticks)))
  const inPowers = (tick: number) => powered(tick, tick === 0 ? 1 : Math.max(1, digits - missing(size, tick)))
  return longest(inPowers) < longest(inFull) ? inPowers : inFull
}

/** Orders of magnitude between two numbers. */
const missing = (size: number, tick: number): number => Math.floor(Math.log10(size) + 1e-9) - Math.floor(Math.log10(Math.abs(tick)) + 1e-9)

/** As `tickDecimals`, negative if tens or hundreds distinguish the ticks. */
function decimalsApart(ticks: readonly number[]): number {
  const least = leastGap(ticks)
  return decimalsOf(Number.isFinite(least) ? least : Math.abs(ticks[0] ?? 1) / 1000, Number.NEGATIVE_INFINITY)
}

/** The width of a label of an axis in its font of 11 px [px]: a dot or a space between thousands is half as wide. */
export function labelWidth(text: string): number {
  return [...text].reduce((sum, letter) => sum + (letter === '.' || letter === NARROW ? 3.2 : 6.4), 0)
}

const significantDecimals = (value: number): number => Math.max(0, 3 - Math.floor(Math.log10(Math.abs(value))))

/** The lowest and the highest value; null without any. Of more values than a call takes arguments. */
export const extremes = (values: readonly number[]): [number, number] | null =>
  values.length === 0 ? null : [values.reduce((a, b) => Math.min(a, b)), values.reduce((a, b) => Math.max(a, b))]

/** A range around the values with padding; never empty. */
export function padded(values: readonly number[], air = 0.06): [number, number] {
  const found = extremes(values.filter(Number.isFinite))
  if (!found) return [0, 1]
  const [low, high] = found
  const reach = (high - low) * air || Math.abs(high) * 0.05 || 1
  return [low - reach, high + reach]
}
