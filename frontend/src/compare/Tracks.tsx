// Plan view of the flights of all runs: nominal grey, worst vermillion, the first run solid, the others dashed.
import { useState } from 'react'
import { AxisBelow, TicksBeside } from '../charts/axes'
import { ChartCard } from '../charts/ChartCard'
import { linearTicks } from '../charts/ticks'
import { useWidth } from '../ui/useWidth'
import { type Shown, WindowSeg } from '../ui/WindowSeg'
import type { Compared } from './data'
import { type Drawn, drawnOf, RunKeys } from './Overlays'
import { Nearest, Obstacle } from '../run/flight/PlanPicture'
import { bodiesOf, line, type Scale, scaleOf, trackOf } from '../run/flight/places'
import { figures } from '../ui/styles'

const [HEIGHT, LEFT, BOTTOM] = [360, 46, 38]

export function Tracks({ runs, className }: { runs: Compared[]; className: string | undefined }) {
  const [window, setWindow] = useState<Shown>('encounter')
  const flights = runs.flatMap(drawnOf)
  const table = () => ({
    name: 'tracks',
    columns: ['flight', 'east, m', 'north, m'],
    rows: flights.flatMap(({ key, trace }) => trackOf(trace).map(({ east, north }) => [key, east, north])),
  })
  return (
    <ChartCard
      title="Trajectories"
      note="Seen from above"
      className={className}
      id="tracks"
      run={runs.map(({ id }) => id).join('-')}
      data={table}
      right={
        <>
          <RunKeys runs={runs} />
          <WindowSeg label="Part shown" value={window} onChange={setWindow} />
        </>
      }
    >
      <Drawing flights={flights} near={window === 'encounter'} />
    </ChartCard>
  )
}

function Drawing({ flights, near }: { flights: Drawn[]; near: boolean }) {
  const [holder, width] = useWidth(520)
  const tracks = flights.map(({ trace }) => trackOf(trace, '', near))
  const bodies = bodiesOf(flights.map((flight) => ({ ...flight, worst: flight.colour === '--c-worst' })))
  const reaches = bodies.flatMap(({ at, reach }) => [
    { east: at.east - reach, north: at.north - reach },
    { east: at.east + reach, north: at.north + reach },
  ])
  const scale = scaleOf([...tracks.flat(), ...reaches], width, HEIGHT, LEFT, BOTTOM)
  return (
    <div ref={holder}>
      <div className="sec micro">North, m</div>
      <svg className={figures.ch} height={HEIGHT} role="img" aria-label={`Trajectories of ${flights.map((f) => f.key).join(', ')}`}>
        <clipPath id="tracks-area">
          <rect x={LEFT} y={4} width={Math.max(0, width - LEFT - 12)} height={HEIGHT - BOTTOM - 4} />
        </clipPath>
        <Grid scale={scale} width={width} />
        <g clipPath="url(#tracks-area)">
          {bodies.map((body) => (
            <Obstacle key={body.key} body={body} scale={scale} />
          ))}
          {flights.map(({ key, colour, of }, i) => (
            <path
              key={key}
              d={line(tracks[i] ?? [], scale)}
              fill="none"
              stroke={`var(${colour})`}
              strokeWidth={1.8}
              strokeDasharray={of.dash.join(' ') || undefined}
              strokeLinejoin="round"
            />
          ))}
          {flights.map(({ key, trace, colour, of }) => (
            <Nearest key={key} trace={trace} colour={`var(${colour})`} scale={scale} size={4} hollow={of.dash.length > 0} />
          ))}
        </g>
      </svg>
    </div>
  )
}

function Grid({ scale, width }: { scale: Scale; width: number }) {
  const [xs, ys] = [linearTicks(...scale.east, width / 90), linearTicks(...scale.north, 6)]
  const foot = HEIGHT - BOTTOM
  return (
    <>
      <AxisBelow ticks={xs} at={(east) => scale.x({ east, north: 0 })} foot={foot} top={10} from={LEFT} to={width - 12} title="East, m" />
      <TicksBeside ticks={ys} at={(north) => scale.y({ east: 0, north })} from={LEFT} to={width - 12} />
    </>
  )
}
