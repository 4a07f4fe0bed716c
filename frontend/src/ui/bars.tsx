// Small drawings for tables: the position of a value within its bounds, and the size of a margin.

interface PlaceProps {
  low: number
  high: number
  nominal: number
  value: number | null
}

/** The position of a value on a line from `from` to `to` [px], whose ends are the bounds. */
const along = ({ low, high }: PlaceProps, from: number, to: number) => (v: number) =>
  from + ((to - from) * (Math.min(Math.max(v, low), high) - low)) / (high - low || 1)

/** Bounds as a line with end ticks, the nominal value as a tick, the value as a dot. */
export function WithinBounds({ width = 104, ...place }: PlaceProps & { width?: number }) {
  const x = along(place, 5, width - 5)
  return (
    <svg width={width} height={14} viewBox={`0 0 ${width} 14`} aria-hidden="true">
      <path d={`M5 7H${width - 5}M5 3.5v7M${width - 5} 3.5v7`} stroke="var(--line-2)" strokeWidth={1.5} />
      <path d={`M${x(place.nominal)} 2v10`} stroke="var(--c-nom)" strokeWidth={2} />
      {place.value !== null && <circle cx={x(place.value)} cy={7} r={4} fill="var(--c-worst)" />}
    </svg>
  )
}

interface MarginProps {
  margin: number
  threshold: number
  /** Only the margin of a cleared run is drawn as satisfied: without that it is the lowest value that was seen. */
  cleared: boolean
}

/** A margin as a fraction of the criterion: to the right if above the threshold, to the left if violated; spans 30 %. */
export function MarginBar({ margin, threshold, cleared }: MarginProps) {
  const share = Math.max(-1, Math.min(1, margin / (0.3 * Math.abs(threshold) || 1)))
  const violated = margin <= 0
  const length = Math.max(1.5, Math.abs(share) * 24)
  return (
    <svg width={50} height={12} viewBox="0 0 50 12" style={{ display: 'block' }} aria-hidden="true">
      <path d="M25 0v12" stroke="var(--line-2)" strokeWidth={1} />
      <rect
        x={violated ? 25 - length : 25}
        y={2.5}
        width={length}
        height={7}
        fill={violated ? 'var(--bad-solid)' : cleared ? 'var(--ok-solid)' : 'var(--unk-solid)'}
      />
    </svg>
  )
}

/** The position of a value within its bounds, for narrow columns; full at a bound, hollow inside. */
export function Place({ bound, ...place }: PlaceProps & { bound: boolean }) {
  const x = along(place, 4, 34)
  return (
    <svg width={38} height={12} viewBox="0 0 38 12" style={{ display: 'block' }} aria-hidden="true">
      <path d="M4 6h30" stroke="var(--line-2)" strokeWidth={1.5} />
      <path d={`M${x(place.nominal)} 1.5v9`} stroke="var(--c-nom)" strokeWidth={1.5} />
      {place.value !== null && (
        <circle
          cx={x(place.value)}
          cy={6}
          r={bound ? 3.2 : 2.6}
          fill={bound ? 'var(--c-worst)' : 'var(--surface)'}
          stroke="var(--c-worst)"
          strokeWidth={1.5}
        />
      )}
    </svg>
  )
}
