// The colour scale from the lowest to the highest value, with the criterion if it is in between.
import { clsx } from 'clsx'
import { useId } from 'react'
import { plain } from '../../format/numbers'
import { symbolText, SvgSign } from '../../ui/Sign'
import { shades } from './colours'
import type { Ink } from './paint'
import { figures } from '../../ui/styles'
import styles from './space.module.css'

const [WIDTH, LEFT] = [180, 8]

export function ColourBar({ ink, symbol, unit, threshold }: { ink: Ink; symbol: string; unit: string; threshold: number | null }) {
  const { low, high, theme } = ink
  const id = useId()
  const palette = ink.turned ? shades(theme).reverse() : shades(theme)
  const at = threshold !== null && threshold >= low && threshold <= high && high > low ? (threshold - low) / (high - low) : null
  return (
    <svg
      className={clsx(figures.ch, styles.bar)}
      style={{ width: WIDTH + 2 * LEFT }}
      height={44}
      role="img"
      aria-label={`Colour: ${symbolText(symbol)} from ${plain(low, 4)} to ${plain(high, 4)} ${unit}`}
    >
      <text x={LEFT + WIDTH / 2} y={11} textAnchor="middle" className={figures.lab}>
        <SvgSign text={symbol} />
        <tspan className={styles.unit}>, {unit}</tspan>
      </text>
      <linearGradient id={id}>
        {palette.map((colour, i) => (
          <stop key={i} offset={i / (palette.length - 1)} stopColor={colour} />
        ))}
      </linearGradient>
      <rect x={LEFT} y={17} width={WIDTH} height={10} fill={`url(#${id})`} />
      {at !== null && <path className={figures.cr} d={`M${LEFT + at * WIDTH} 14v16`} />}
      <text x={LEFT} y={41}>
        {plain(low, 4)}
      </text>
      <text x={LEFT + WIDTH} y={41} textAnchor="end">
        {plain(high, 4)}
      </text>
    </svg>
  )
}
