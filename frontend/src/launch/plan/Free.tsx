// The region around an obstacle that must stay free in plan view: about its centre, or offset from its surface.
import { freeOf, type PlanBody } from './plan'
import { degrees } from './ways'

interface FreeProps {
  body: PlanBody
  /** The required distance [m]; not drawn for 0. */
  reach: number
  /** Whether it is measured from the surface, not from the centre. */
  surface: boolean
  /** The obstacle's centre [px]. */
  x: number
  y: number
  /** Pixels per metre. */
  scale: number
}

const LOOK = { fill: 'none', stroke: 'var(--c-crit)', strokeDasharray: '4 3' }

export function Free({ body, reach, surface, x, y, scale }: FreeProps) {
  if (reach <= 0) return null
  const { rectangle } = body
  if (!surface || !rectangle) return <circle cx={x} cy={y} r={freeOf(body, reach, surface) * scale} {...LOOK} />
  const [long, wide] = [(rectangle.length + 2 * reach) * scale, (rectangle.width + 2 * reach) * scale]
  return (
    <rect
      x={-0.5 * long}
      y={-0.5 * wide}
      width={long}
      height={wide}
      rx={reach * scale}
      transform={`translate(${x} ${y}) rotate(${degrees(-rectangle.angle)})`}
      {...LOOK}
    />
  )
}
