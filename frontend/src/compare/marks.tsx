// How the runs are told apart on a common axis: the first filled, the second hollow, the third and fourth smaller.

export const MarkKeys = ({ letters }: { letters: readonly string[] }) => (
  <span className="lg">
    {letters.map((letter, i) => (
      <span key={letter} className="k">
        <svg width={14} height={14} aria-hidden="true">
          <Mark x={7} y={7} index={i} colour="var(--ink-2)" />
        </svg>
        {letter}
      </span>
    ))}
  </span>
)

interface MarkProps {
  x: number
  y: number
  index: number
  colour: string
}

export function Mark({ x, y, index, colour }: MarkProps) {
  return (
    <circle
      cx={x}
      cy={y}
      r={index < 2 ? 4 : 2.6}
      fill={index % 2 === 0 ? colour : 'var(--surface)'}
      stroke={colour}
      strokeWidth={1.6}
    />
  )
}

/** From one value to another, dashed for all runs but the first. */
export function Span({ from, to, y, index }: { from: number; to: number; y: number; index: number }) {
  const colour = 'var(--ink-2)'
  return (
    <>
      <path
        d={`M${from} ${y}H${to}`}
        stroke={colour}
        strokeWidth={1.8}
        strokeDasharray={index === 0 ? undefined : '4 3'}
      />
      <Mark x={from} y={y} index={index} colour={colour} />
      <Mark x={to} y={y} index={index} colour={colour} />
    </>
  )
}
