// Sparkline of the convergence history over evaluations (log); the criterion dashed.

interface SparkProps {
  course: readonly (readonly [number, number] | number[])[]
  /** Where the search ended. */
  evaluations: number
  threshold: number | null
  violated: boolean
}

const [WIDTH, HEIGHT, PAD] = [98, 26, 4]

export function Spark({ course, evaluations, threshold, violated }: SparkProps) {
  if (course.length === 0) return <span className="mut">{'\u2014'}</span>
  const values = course.map(([, value = 0]) => value)
  const known = threshold === null ? values : [...values, threshold]
  const [low, high] = [Math.min(...known), Math.max(...known)]
  const last = Math.max(evaluations, course[course.length - 1]?.[0] ?? 1, 2)
  // Counted from the start of the search: earlier evaluations would leave half of a log axis empty.
  const before = (course[0]?.[0] ?? 1) - 1
  const x = (n: number) => 1 + ((WIDTH - 6) * Math.log(Math.max(1, n - before))) / Math.log(Math.max(2, last - before))
  const y = (v: number) => PAD + ((HEIGHT - 2 * PAD) * (high - v)) / (high - low || 1)
  const path = course.map(([n = 1, v = 0], i) => (i === 0 ? `M${x(n)} ${y(v)}` : `H${x(n)}V${y(v)}`)).join('')
  const end = values[values.length - 1] ?? 0
  const colour = violated ? 'var(--c-worst)' : 'var(--ink-2)'
  return (
    <svg width={WIDTH} height={HEIGHT} viewBox={`0 0 ${WIDTH} ${HEIGHT}`} style={{ display: 'block' }} aria-hidden="true">
      {threshold !== null && (
        <path d={`M1 ${y(threshold)}H${WIDTH - 2}`} stroke="var(--c-crit)" strokeDasharray="3 2.5" strokeWidth={1} opacity={0.75} />
      )}
      <path d={`${path}H${x(last)}`} fill="none" stroke={colour} strokeWidth={1.4} />
      <circle cx={x(last)} cy={y(end)} r={2} fill={colour} />
    </svg>
  )
}
