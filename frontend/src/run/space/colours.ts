// Colours of values: viridis (S. van der Walt and N. Smith, matplotlib 1.5; CC0), the part of it that contrasts with the
// page's background. The lowest values contrast most in both themes.
import type { Theme } from '../../theme/useTheme'

/** Viridis in steps of a tenth. */
const VIRIDIS: readonly (readonly [number, number, number])[] = [
  [68, 1, 84],
  [72, 36, 117],
  [65, 68, 135],
  [53, 95, 141],
  [42, 120, 142],
  [33, 145, 140],
  [34, 168, 132],
  [68, 191, 112],
  [122, 209, 81],
  [189, 223, 38],
  [253, 231, 37],
]

/** The part of the scale used from the lowest to the highest value. */
const PART: Record<Theme, readonly [number, number]> = { light: [0, 0.58], dark: [1, 0.41] }

/** Number of distinct colours: elements of one colour are drawn in one path. */
export const SHADES = 40

/** The colour at a fraction of the value range, 0 at the lowest. */
export function colourOf(share: number, theme: Theme): string {
  return `rgb(${rgbOf(share, theme).join(', ')})`
}

export function rgbOf(share: number, theme: Theme): [number, number, number] {
  const [from, to] = PART[theme]
  const at = (from + Math.min(1, Math.max(0, share)) * (to - from)) * (VIRIDIS.length - 1)
  const below = Math.min(VIRIDIS.length - 2, Math.floor(at))
  const [a, b] = [VIRIDIS[below], VIRIDIS[below + 1]] as [readonly number[], readonly number[]]
  const mixed = a.map((channel, i) => Math.round(channel + (at - below) * ((b[i] as number) - channel)))
  return mixed as [number, number, number]
}

/** The shade of a value; lower values have lower shades. */
export function shadeOf(value: number, low: number, high: number): number {
  if (!(high > low)) return 0
  return Math.min(SHADES - 1, Math.max(0, Math.floor(((value - low) / (high - low)) * SHADES)))
}

export const shades = (theme: Theme): string[] =>
  Array.from({ length: SHADES }, (_, i) => colourOf(i / (SHADES - 1), theme))
