// The region of attraction about trim in the plane of two states, with the ends of simulations, and its statement.
import { useState } from 'react'
import type { AttractionOfResult } from '../../api/stages'
import type { TrimState } from '../../client'
import { AxisBelow, TicksBeside } from '../../charts/axes'
import { linearTicks, padded } from '../../charts/ticks'
import { sentence } from '../../format/spans'
import { unitText } from '../../format/units'
import { Card } from '../../ui/Card'
import { Select } from '../../ui/Select'
import { Spans } from '../../ui/Spans'
import { useWidth } from '../../ui/useWidth'
import { outline, type Point } from './outline'
import { figures } from '../../ui/styles'

export function AttractionCard({ result }: { result: AttractionOfResult }) {
  const { sections, states } = result
  const [chosen, choose] = useState(0)
  const named = (k: number) => states[k]?.symbol ?? ''
  const section = sections[chosen]
  const [x, y] = section ? section.states.map((k) => states[k]) : []
  return (
    <Card
      title="Region of attraction about trim"
      note={section ? 'Proved for the polynomial model, not for the loop as flown' : undefined}
      id="attraction"
      footer={<Spans spans={sentence(result.statement)} />}
    >
      {section && x && y && (
        <>
          {sections.length > 1 && (
            <Select
              label="Section"
              value={String(chosen)}
              onChange={(value) => choose(Number(value))}
              options={sections.map(({ states: [a, b] }, i) => ({ value: String(i), label: `${named(a ?? 0)} and ${named(b ?? 0)}` }))}
            />
          )}
          <Section proved={outline(section.proved, x, y)} simulated={outline(section.simulated, x, y)} x={x} y={y} />
        </>
      )}
    </Card>
  )
}

const [HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [300, 58, 14, 8, 40]

interface SectionProps {
  proved: readonly Point[]
  simulated: readonly Point[]
  x: TrimState
  y: TrimState
}

function Section({ proved, simulated, x, y }: SectionProps) {
  const [holder, width] = useWidth(420)
  const every = [...proved, ...simulated]
  const [[left, right], [low, high]] = [padded(every.map(([a]) => a)), padded(every.map(([, b]) => b))]
  const across = (value: number) => LEFT + ((value - left) / (right - left)) * (width - LEFT - RIGHT)
  const up = (value: number) => HEIGHT - BOTTOM - ((value - low) / (high - low)) * (HEIGHT - BOTTOM - TOP)
  const [below, beside] = [linearTicks(left, right, 4), linearTicks(low, high, 4)]
  const title = (state: TrimState) => `${state.symbol}, ${unitText(state.unit)}`
  const path = proved.map(([a, b], i) => `${i ? 'L' : 'M'}${across(a).toFixed(1)} ${up(b).toFixed(1)}`).join('')
  return (
    <div ref={holder}>
      <div className="sec micro">{title(y)}</div>
      <svg className={figures.ch} height={HEIGHT} role="img" aria-label={`Section of ${title(x)} and ${title(y)}: proved region and simulated ends`}>
        <TicksBeside ticks={beside} at={up} from={LEFT} to={width - RIGHT} />
        <AxisBelow ticks={below} at={across} foot={HEIGHT - BOTTOM} from={LEFT} to={width - RIGHT} title={title(x)} />
        <path d={`${path}Z`} fill="var(--ok)" fillOpacity={0.15} stroke="var(--ok)" strokeWidth={1.8} />
        {simulated.map(([a, b], i) => (
          <circle key={i} cx={across(a)} cy={up(b)} r={3} fill="var(--c-nom)" />
        ))}
        <path d={`M${across(x.trim) - 5} ${up(y.trim)}h10m-5 -5v10`} stroke="var(--ink)" strokeWidth={1.25} />
      </svg>
      <div className={figures.lg}>
        <span className={figures.k}>
          <svg className={figures.mk} viewBox="0 0 10 10" aria-hidden="true">
            <rect width="10" height="10" fill="var(--ok)" fillOpacity={0.4} stroke="var(--ok)" />
          </svg>
          V &lt; 1, proved
        </span>
        <span className={figures.k}>
          <svg className={figures.mk} viewBox="0 0 10 10" aria-hidden="true">
            <circle cx="5" cy="5" r="3" fill="var(--c-nom)" />
          </svg>
          Up to here the loop returns in simulation
        </span>
        <span className={figures.k}>+ Trim</span>
      </div>
      <p className={figures.fig}>A section: the other states are at trim.</p>
    </div>
  )
}
