// A scenario seen from above, from its document alone: start with heading, goal, obstacles; nothing is simulated.
import type { Campaign, Raw } from '../api/campaign'
import { numberOf } from './parameters'

interface PlanViewProps {
  campaign: Campaign
  height?: number
}

interface Place {
  x: number
  y: number
}

const WIDTH = 320

const at = (values: Record<string, Raw> | undefined, prefix = ''): Place => ({
  x: numberOf(values?.[`${prefix}x`]) ?? 0,
  y: numberOf(values?.[`${prefix}y`]) ?? 0,
})

export function PlanView({ campaign, height = 150 }: PlanViewProps) {
  const { scenario, criterion } = campaign
  const start = at(scenario.start)
  const goal = at(scenario.goal)
  const heading = numberOf(scenario.start?.theta ?? scenario.start?.psi) ?? 0
  const reach = numberOf(criterion.threshold) ?? 0
  const circles = (scenario.obstacles ?? []).map((o) => ({
    ...at(o.parameters, 'position.'),
    r: numberOf(o.parameters?.radius) ?? 0,
  }))
  const points = [start, goal, ...circles.flatMap((c) => around(c, Math.max(c.r, reach)))]
  const view = frame(points, height)
  const length = 0.1 * height
  return (
    <svg
      viewBox={`0 0 ${WIDTH} ${height}`}
      width="100%"
      height={height}
      preserveAspectRatio="xMidYMid slice"
      style={{ display: 'block' }}
      role="img"
      aria-label={`Plan of ${campaign.name}: start, goal and ${circles.length} obstacles`}
    >
      <Grid view={view} height={height} />
      <path
        d={`M${view.x(start)} ${view.y(start)}L${view.x(goal)} ${view.y(goal)}`}
        stroke="var(--c-nom)"
        strokeDasharray="2 4"
        strokeWidth={1.3}
      />
      {circles.map((c, i) => (
        <g key={i}>
          <circle
            cx={view.x(c)}
            cy={view.y(c)}
            r={Math.max(3, c.r * view.scale)}
            fill="var(--c-obs)"
            fillOpacity={0.22}
            stroke="var(--c-obs)"
            strokeWidth={1.4}
          />
          <circle
            cx={view.x(c)}
            cy={view.y(c)}
            r={reach * view.scale}
            fill="none"
            stroke="var(--c-crit)"
            strokeDasharray="4 3"
          />
        </g>
      ))}
      <g transform={`translate(${view.x(start)} ${view.y(start)}) rotate(${(-heading * 180) / Math.PI})`}>
        <path
          d={`M${length} 0 L${-0.6 * length} ${0.55 * length} L${-0.3 * length} 0 L${-0.6 * length} ${-0.55 * length}Z`}
          fill="var(--ink-2)"
        />
      </g>
      <path
        d={`M${view.x(goal) - 5} ${view.y(goal)}h10M${view.x(goal)} ${view.y(goal) - 5}v10`}
        stroke="var(--ink)"
        strokeWidth={1.8}
      />
      <circle cx={view.x(goal)} cy={view.y(goal)} r={7.5} fill="none" stroke="var(--ink)" strokeWidth={1.3} />
    </svg>
  )
}

const around = (c: Place, r: number): Place[] => [
  { x: c.x - r, y: c.y - r },
  { x: c.x + r, y: c.y + r },
]

interface View {
  scale: number
  x: (p: Place) => number
  y: (p: Place) => number
}

/** Fits all points into the picture with equal scales, y upwards. */
function frame(points: Place[], height: number): View {
  const xs = points.map((p) => p.x)
  const ys = points.map((p) => p.y)
  const [x0, x1] = [Math.min(...xs), Math.max(...xs)]
  const [y0, y1] = [Math.min(...ys), Math.max(...ys)]
  const scale = Math.min((WIDTH - 80) / (x1 - x0 || 1), (height - 44) / (y1 - y0 || 1))
  return {
    scale,
    x: (p) => WIDTH / 2 + (p.x - (x0 + x1) / 2) * scale,
    y: (p) => height / 2 - (p.y - (y0 + y1) / 2) * scale,
  }
}

/** Grid lines at a round spacing. */
function Grid({ view, height }: { view: View; height: number }) {
  const raw = 36 / view.scale
  const power = 10 ** Math.floor(Math.log10(raw))
  const step = ([1, 2, 5, 10].find((m) => m * power >= raw) ?? 10) * power * view.scale
  const [ox, oy] = [view.x({ x: 0, y: 0 }), view.y({ x: 0, y: 0 })]
  const first = (origin: number) => ((origin % step) + step) % step
  const lines: string[] = []
  for (let x = first(ox); x <= WIDTH; x += step) lines.push(`M${x} 0V${height}`)
  for (let y = first(oy); y <= height; y += step) lines.push(`M0 ${y}H${WIDTH}`)
  return <path d={lines.join('')} stroke="var(--vp-line)" strokeWidth={0.7} fill="none" />
}
