// Plan view of a finding's flight and the nominal one around the closest approach, with the obstacle and the required
// distance. The geometry is that of the compared flights.
import type { TraceData } from '../../client'
import { bodiesOf, type Body, type Drawable, line, placeOf, type Scale, scaleOf, trackOf } from './places'

interface PlanPictureProps {
  flight: TraceData
  nominal: TraceData | undefined
  name: string
  /** [px] */
  size: readonly [number, number]
}

export function PlanPicture({ flight, nominal, name, size: [width, height] }: PlanPictureProps) {
  const alone = name === 'nominal'
  const drawn: Drawable[] = [
    ...(nominal && !alone ? [{ key: 'nominal', worst: false, trace: nominal }] : []),
    { key: name, worst: !alone, trace: flight },
  ]
  const tracks = drawn.map(({ trace }) => trackOf(trace, '', true))
  const bodies = bodiesOf([{ key: name, worst: true, trace: flight }])
  const corners = bodies.flatMap(({ at, reach, radius }) =>
    [-1, 1].map((way) => ({ east: at.east + way * Math.max(reach, radius), north: at.north + way * Math.max(reach, radius) })),
  )
  const scale = scaleOf([...tracks.flat(), ...corners], width, height, 4, 0)
  return (
    <svg
      viewBox={`0 0 ${width} ${height}`}
      width={width}
      height={height}
      role="img"
      aria-label={`${name} seen from above at its closest approach`}
    >
      {bodies.map((body) => (
        <Obstacle key={body.key} body={body} scale={scale} />
      ))}
      {drawn.map(({ key, worst }, i) => (
        <path
          key={key}
          d={line(tracks[i] ?? [], scale)}
          fill="none"
          stroke={worst ? 'var(--c-worst)' : 'var(--c-nom)'}
          strokeWidth={worst ? 1.8 : 1.4}
          strokeLinejoin="round"
        />
      ))}
      <Nearest trace={flight} colour={alone ? 'var(--c-nom)' : 'var(--c-worst)'} scale={scale} />
    </svg>
  )
}

export function Obstacle({ body: { at, radius, reach, track }, scale }: { body: Body; scale: Scale }) {
  const [x, y] = [scale.x(at), scale.y(at)]
  return (
    <>
      {track.length > 1 && (
        <path d={line(track, scale)} fill="none" stroke="var(--c-obs)" strokeWidth={1.2} strokeDasharray="4 3" />
      )}
      <circle cx={x} cy={y} r={Math.max(2, radius * scale.ratio)} fill="var(--c-obs)" fillOpacity={0.2} stroke="var(--c-obs)" />
      {reach > 0 && (
        <circle cx={x} cy={y} r={reach * scale.ratio} fill="none" stroke="var(--c-crit)" strokeDasharray="3 3" />
      )}
    </>
  )
}

interface NearestProps {
  trace: TraceData
  colour: string
  scale: Scale
  /** Radius of the vehicle's mark [px]. */
  size?: number
  hollow?: boolean
}

/** The closest approach: the line between vehicle and obstacle. */
export function Nearest({ trace, colour, scale, size = 3, hollow = false }: NearestProps) {
  const { closest, frame } = trace.meta
  if (!closest) return null
  const here = placeOf(closest.position, frame)
  return (
    <>
      <path d={line([here, placeOf(closest.obstacle_position, frame)], scale)} stroke={colour} strokeDasharray="2 2" />
      <circle
        cx={scale.x(here)}
        cy={scale.y(here)}
        r={size}
        fill={hollow ? 'var(--surface)' : colour}
        stroke={hollow ? colour : 'var(--surface)'}
        strokeWidth={0.4 * size}
      />
    </>
  )
}
