// Plan view of the flights of all runs: nominal grey, worst vermillion, the first run solid, the others dashed.
import { useState } from 'react'
import { ChartCard } from '../charts/ChartCard'
import { linearTicks, tickText } from '../charts/ticks'
import type { TraceData } from '../client'
import { useWidth } from '../ui/useWidth'
import { type Shown, WindowSeg } from '../ui/WindowSeg'
import type { Compared } from './data'
import { RunKeys } from './Overlays'
import { bodiesOf, line, placeOf, type Scale, scaleOf, trackOf } from '../run/flight/places'
import figures from '../ui/figures.module.css'

const [HEIGHT, LEFT, BOTTOM] = [360, 46, 38]

interface Flight {
  key: string
  colour: string
  dash: string | undefined
  trace: TraceData
  of: Compared
}

export function Tracks({ runs, className }: { runs: Compared[]; className: string | undefined }) {
  const [window, setWindow] = useState<Shown>('encounter')
  const flights = runs.flatMap((of) => {
    const pairs: [string, string, TraceData | undefined][] = [
      ['nominal', 'var(--c-nom)', of.nominal],
      ['worst', 'var(--c-worst)', of.worst],
    ]
    return pairs.flatMap(([name, colour, trace]): Flight[] =>
      trace ? [{ key: `${of.letter} ${name}`, colour, dash: of.dash.join(' ') || undefined, trace, of }] : [],
    )
  })
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

function Drawing({ flights, near }: { flights: Flight[]; near: boolean }) {
  const [holder, width] = useWidth(520)
  const tracks = flights.map(({ trace }) => trackOf(trace, '', near))
  const bodies = bodiesOf(flights.map((flight) => ({ ...flight, worst: flight.colour.includes('worst') })))
  const reaches = bodies.flatMap(({ at, reach }) => [
    { east: at.east - reach, north: at.north - reach },
    { east: at.east + reach, north: at.north + reach },
  ])
  const scale = scaleOf([...tracks.flat(), ...reaches], width, HEIGHT, LEFT, BOTTOM)
  return (
    <div ref={holder}>
      <div className={figures.ytitle}>North, m</div>
      <svg className={figures.ch} height={HEIGHT} role="img" aria-label={`Trajectories of ${flights.map((f) => f.key).join(', ')}`}>
        <clipPath id="tracks-area">
          <rect x={LEFT} y={4} width={Math.max(0, width - LEFT - 12)} height={HEIGHT - BOTTOM - 4} />
        </clipPath>
        <Grid scale={scale} width={width} />
        <g clipPath="url(#tracks-area)">
          {bodies.map(({ key, at, radius, reach, track }) => (
            <g key={key}>
              {track.length > 1 && (
                <path d={line(track, scale)} fill="none" stroke="var(--c-obs)" strokeWidth={1.3} strokeDasharray="6 4" />
              )}
              <circle
                cx={scale.x(at)}
                cy={scale.y(at)}
                r={Math.max(2.5, radius * scale.ratio)}
                fill="var(--c-obs)"
                fillOpacity={0.12}
                stroke="var(--c-obs)"
              />
              {reach > 0 && (
                <circle
                  cx={scale.x(at)}
                  cy={scale.y(at)}
                  r={reach * scale.ratio}
                  fill="none"
                  stroke="var(--c-crit)"
                  strokeDasharray="5 4"
                />
              )}
            </g>
          ))}
          {flights.map(({ key, colour, dash }, i) => (
            <path
              key={key}
              d={line(tracks[i] ?? [], scale)}
              fill="none"
              stroke={colour}
              strokeWidth={1.8}
              strokeDasharray={dash}
              strokeLinejoin="round"
            />
          ))}
          {flights.map((flight) => (
            <Closest key={flight.key} flight={flight} scale={scale} />
          ))}
        </g>
      </svg>
    </div>
  )
}

function Closest({ flight: { trace, colour, dash }, scale }: { flight: Flight; scale: Scale }) {
  const { closest, frame } = trace.meta
  if (!closest) return null
  const [here, there] = [placeOf(closest.position, frame), placeOf(closest.obstacle_position, frame)]
  return (
    <>
      <path d={line([here, there], scale)} stroke={colour} strokeDasharray="2 2" />
      <circle
        cx={scale.x(here)}
        cy={scale.y(here)}
        r={4}
        fill={dash ? 'var(--surface)' : colour}
        stroke={dash ? colour : 'var(--surface)'}
        strokeWidth={1.6}
      />
    </>
  )
}

function Grid({ scale, width }: { scale: Scale; width: number }) {
  const [xs, ys] = [linearTicks(...scale.east, width / 90), linearTicks(...scale.north, 6)]
  const foot = HEIGHT - BOTTOM
  return (
    <>
      {xs.map((tick) => (
        <g key={`x${tick}`}>
          <path className={figures.g} d={`M${scale.x({ east: tick, north: 0 })} 10V${foot}`} />
          <text x={scale.x({ east: tick, north: 0 })} y={foot + 15} textAnchor="middle">
            {tickText(xs)(tick)}
          </text>
        </g>
      ))}
      {ys.map((tick) => (
        <g key={`y${tick}`}>
          <path className={figures.g} d={`M${LEFT} ${scale.y({ east: 0, north: tick })}H${width - 12}`} />
          <text x={LEFT - 6} y={scale.y({ east: 0, north: tick }) + 4} textAnchor="end">
            {tickText(ys)(tick)}
          </text>
        </g>
      ))}
      <path className={figures.a} d={`M${LEFT} ${foot}H${width - 12}`} />
      <text x={(LEFT + width) / 2} y={HEIGHT - 4} textAnchor="middle">
        East, m
      </text>
    </>
  )
}
