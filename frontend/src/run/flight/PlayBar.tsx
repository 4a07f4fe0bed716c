// The controls below the 3D view: playback, time, speed, and visible layers.
import {
  IconFocusCentered,
  IconLayoutSidebarRightCollapse,
  IconLayoutSidebarRightExpand,
  IconPlayerPause,
  IconPlayerPlay,
  IconStack2,
} from '@tabler/icons-react'
import { clsx } from 'clsx'
import { type CSSProperties, useState } from 'react'
import type { LayersChange, ViewState } from '../../client'
import { fixed, plain } from '../../format/numbers'
import { caseWord, hasScenario } from '../../api/campaign'
import { useBarred } from '../../api/may'
import { IconButton } from '../../ui/IconButton'
import { Menu, Pick, Picks } from '../../overlay/Menu'
import { calledOf, NOMINAL } from '../data/chosen'
import type { RunData } from '../data/data'
import type { View } from './view'
import { WhatIfButton } from './WhatIfButton'
import type { WhatIfState } from './useWhatIf'
import { Select } from '../../ui/Select'
import { fields, layout } from '../../ui/styles'
import styles from './flight.module.css'
import { useBrief } from '../../ui/useBrief'

const SPEEDS = [0.25, 0.5, 1, 2, 5]

interface Props {
  data: RunData
  view: View
  /** The displayed state; null while the view is not open. */
  shown: ViewState | null
}

interface BarProps extends Props {
  whatIf: WhatIfState
}

export function PlayBar({ data, view, shown, whatIf }: BarProps) {
  const { playing = false, speed = 1, panel = false } = shown ?? {}
  const flies = hasScenario(data.campaign)
  return (
    <div className={clsx(layout.row, styles.playbar)} role="group" aria-label={flies ? 'Time of the flight' : 'Time of the case'}>
      <IconButton
        label={playing ? 'Pause' : 'Play'}
        title={`${playing ? 'Pause' : 'Play'} (space)`}
        icon={playing ? IconPlayerPause : IconPlayerPlay}
        off={shown === null}
        act={() => view.toggle()}
      />
      <Scrubber data={data} view={view} shown={shown} />
      {flies && (
        <IconButton
          label="Closest approach"
          title="To the closest approach (Home)"
          icon={IconFocusCentered}
          off={shown === null}
          act={() => view.steer({ closest: true })}
        />
      )}
      <Select
        label="Speed of play"
        value={speed}
        options={SPEEDS.map((pace) => ({ value: pace, label: `${plain(pace)}×` }))}
        disabled={shown === null}
        onChange={(pace) => view.steer({ speed: pace })}
      />
      {shown && <LayersMenu data={data} view={view} shown={shown} />}
      <WhatIfButton whatIf={whatIf} flies={flies} />
      <IconButton
        label={panel ? 'Close the panel' : 'Open the panel'}
        title={`${panel ? 'Close' : 'Open'} the details: values and search`}
        icon={panel ? IconLayoutSidebarRightCollapse : IconLayoutSidebarRightExpand}
        off={shown === null}
        act={() => view.steer({ panel: !panel })}
      />
    </div>
  )
}

function Scrubber({ data, view, shown }: Props) {
  const horizon = hasScenario(data.campaign) ? Number(data.campaign.scenario.horizon) : (shown?.horizon ?? 0)
  /** The dragged position, until the view has reached it. */
  const [position, setPosition] = useState<number | null>(null)
  const time = shown?.time ?? 0
  if (position !== null && (shown === null || shown.playing || Math.abs(time - position) < 0.006)) setPosition(null)
  const at = position ?? time
  return (
    <>
      <output className={clsx('b num', styles.instant)}>{shown ? `${fixed(at, 2)} s` : '—'}</output>
      <span className={clsx(layout.row, fields.scrub)}>
        <input
          type="range"
          aria-label="Time"
          aria-valuetext={`${fixed(at, 2)} seconds`}
          min={0}
          max={horizon}
          step={0.01}
          value={at}
          disabled={shown === null}
          style={{ '--done': `${horizon > 0 ? (100 * at) / horizon : 0}%` } as CSSProperties}
          onChange={(event) => {
            setPosition(Number(event.target.value))
            view.steer({ time: Number(event.target.value) })
          }}
        />
        {nearest(data).map(({ name, time: when, colour }) => (
          <i
            key={name}
            title={`${name}: closest at ${fixed(when, 2)} s`}
            style={{ '--at': when / horizon, background: colour } as CSSProperties}
          />
        ))}
      </span>
      <span className="small mut num">{horizon > 0 ? `${plain(Number(horizon.toFixed(2)))} s` : ''}</span>
    </>
  )
}

/** Times of the closest approaches of the visible flights. */
function nearest({ nominalTrace, findingTrace, chosen, run }: RunData) {
  const flights = [
    { name: 'Nominal', trace: nominalTrace, colour: 'var(--c-nom)' },
    { name: calledOf({ run, chosen }), trace: chosen === NOMINAL ? undefined : findingTrace, colour: 'var(--c-worst)' },
  ]
  return flights.flatMap(({ name, trace, colour }) => {
    const time = trace?.meta.closest?.time
    return time === undefined ? [] : [{ name, time, colour }]
  })
}

/** The layers and their titles. */
type Layer = Exclude<keyof LayersChange, 'trail'>

function LayersMenu({ data, view, shown }: Props & { shown: ViewState }) {
  const flies = hasScenario(data.campaign)
  const word = caseWord(data.campaign)
  const barred = useBarred('engineer')
  const names: [Layer, string][] = [
    ['nominal', `Nominal ${word}`],
    ...(shown.flight === NOMINAL ? [] : ([['finding', `${calledOf(data)} ${word}`]] as [Layer, string][])),
    ...(shown.what_if ? ([['what_if', `What-if ${word}`]] as [Layer, string][]) : []),
    ['velocity', 'Velocity'],
    ['relative', 'Relative velocity'],
    // These two are simulated for the view.
    ...(barred ? [] : ([['sampled', `Sampled ${word}s`]] as [Layer, string][])),
    // A simulator has no avoider that is known, and so no field.
    ...(flies && !barred ? ([['field', 'Field of the avoider']] as [Layer, string][]) : []),
  ]
  return (
    <Menu name="Shown" value={null} on={false} icon={<IconStack2 className="i mut" aria-hidden />} above>
      <Picks label="What is drawn">
        {names.map(([layer, name]) => (
          <LayerPick
            key={layer}
            name={name}
            on={shown.layers[layer]}
            ask={(on) => view.steer({ layers: { [layer]: on } })}
          />
        ))}
        <LayerPick
          name="Paths only up to this time"
          on={shown.layers.trail === 'so_far'}
          ask={(on) => view.steer({ layers: { trail: on ? 'so_far' : 'whole' } })}
        />
      </Picks>
    </Menu>
  )
}

/** How long a checkbox shows the requested value without confirmation by the view [ms]. */
const WAIT = 3000

/** A checkbox with immediate feedback, finally set by the view. */
function LayerPick({ name, on, ask }: { name: string; on: boolean; ask: (on: boolean) => void }) {
  const [request, setRequest] = useBrief<boolean>(WAIT)
  if (request === on) setRequest(null)
  const change = (wanted: boolean) => {
    setRequest(wanted)
    ask(wanted)
  }
  return (
    <Pick on={request ?? on} onChange={change}>
      <span className={layout.grow}>{name}</span>
    </Pick>
  )
}
