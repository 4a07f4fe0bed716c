// Axis ticks, and ranges that contain given values.

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
  const gaps = ticks.slice(1).map((tick, i) => Math.abs(tick - (ticks[i] as number)))
  const least = Math.min(...gaps.filter((gap) => gap > 0))
  if (!Number.isFinite(least)) return ticks.length === 1 && ticks[0] !== 0 ? significantDecimals(ticks[0] as number) : 0
  let decimals = Math.max(0, -Math.floor(Math.log10(least) + 1e-9))
  const scaled = least * 10 ** decimals
  if (Math.abs(scaled - Math.round(scaled)) > 1e-6) decimals += 1
  return decimals
}

const significantDecimals = (value: number): number => Math.max(0, 3 - Math.floor(Math.log10(Math.abs(value))))

/** A range around the values with padding; never empty. */
export function padded(values: readonly number[], log = false, air = 0.06): [number, number] {
  const finite = values.filter((value) => Number.isFinite(value) && (!log || value > 0))
  if (finite.length === 0) return log ? [1, 10] : [0, 1]
  let low = finite[0] as number
  let high = low
  for (const value of finite) {
    if (value < low) low = value
    if (value > high) high = value
  }
  if (log) {
    const reach = Math.max((high / low) ** air, 1.02)
    return [low / reach, high * reach]
  }
  const reach = (high - low) * air || Math.abs(high) * 0.05 || 1
  return [low - reach, high + reach]
}
