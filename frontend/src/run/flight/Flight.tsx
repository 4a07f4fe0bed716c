// The flight in 3D: the viewer runs in its own frame; all its numbers are also on this page.
import { useSearch } from '@tanstack/react-router'
import { useEffect, useEffectEvent, useLayoutEffect, useState, useSyncExternalStore } from 'react'
import { hasScenario } from '../../api/campaign'
import { useTheme } from '../../theme/useTheme'
import { Card } from '../../ui/Card'
import { useCalm } from '../../ui/useCalm'
import { useNear } from '../../ui/useNear'
import { calledOf } from '../data/chosen'
import { leavesGround, type RunData } from '../data/data'
import { graphics } from './drawable'
import { FlightHead } from './FlightHead'
import { noiseOf } from './flown'
import { FlightNotice, NotDrawable } from './FlightNotice'
import { PlayBar } from './PlayBar'
import { Still } from './Still'
import { useInstant } from './useInstant'
import type { View } from './view'
import type { WhatIfState } from './useWhatIf'
import runStyles from '../run.module.css'

interface FlightProps {
  data: RunData
  view: View
  whatIf: WhatIfState
  className: string | undefined
  /** The page shows only the flight: actions of other cards are in its header. */
  alone?: boolean
}

export function Flight({ data, view, whatIf, className, alone = false }: FlightProps) {
  const theme = useTheme()
  const title = leavesGround(data) ? 'Flight' : '3D view'
  const named = title === 'Flight' ? 'Flight in 3D' : title
  // A viewer uses resources of the service: it is opened when it comes near the window.
  const [holder, near] = useNear<HTMLDivElement>()
  const wanted = useCalm() && near
  const { t, cam } = useSearch({ from: '/runs/$id' })
  // A page of its own, and a link to an instant or a camera, ask for the view.
  const [asked, setAsked] = useState(alone || t !== undefined || cam !== undefined)
  const drawnBy = wanted ? graphics() : 'hardware'
  const still = drawnBy === 'software' && !asked
  const ready = wanted && drawnBy !== 'none' && !still
  const open = useEffectEvent(() => view.open({ time: t, camera: cam }))
  const known = useSyncExternalStore(view.subscribe, () => view.known)

  useLayoutEffect(() => view.want({ flight: data.chosen, theme }), [view, data.chosen, theme])
  // Opened once: later changes are sent with its key.
  // Closed before its frame is removed: otherwise the service would report that the view is lost.
  useLayoutEffect(() => (ready ? open() : undefined), [view, ready])
  useEffect(() => keysOf(holder.current?.closest('section'), view), [view, holder])
  useInstant(view, data.run.id)

  return (
    <Card
      title={title}
      note={<span title="Drag to turn, wheel to zoom. Vehicles not to scale">{flights(data, whatIf.whatIf !== null)}</span>}
      className={className}
      id="flight"
      flush
      right={
        <FlightHead
          data={data}
          view={view}
          shown={known.shown}
          alone={alone}
          onCamera={(camera) => {
            setAsked(true) // who chooses a camera wants to see from there
            view.steer({ camera })
          }}
          onFull={() => void holder.current?.requestFullscreen().catch(() => undefined)}
        />
      }
    >
      <div className={runStyles.flightbox} ref={holder}>
        <div className={runStyles.flight} role="group" aria-label={`${named} and its keys`} tabIndex={0}>
          {known.address && (
            <iframe
              key={`${view.key}.${known.frame}`}
              src={known.address}
              title={named}
              allow="fullscreen"
              sandbox="allow-scripts"
              inert={known.phase !== 'open'}
            />
          )}
          {drawnBy === 'none' ? (
            <NotDrawable what={hasScenario(data.campaign) ? 'flight' : 'case'} alone={alone} />
          ) : still ? (
            <Still data={data} onOpen={() => setAsked(true)} />
          ) : (
            <FlightNotice known={known} onRetry={() => view.retry()} />
          )}
        </div>
        <PlayBar data={data} view={view} shown={known.shown} whatIf={whatIf} />
      </div>
    </Card>
  )
}

/** With focus in the card: space plays, arrows step, Home goes to the closest approach. */
function keysOf(card: Element | null | undefined, view: View): (() => void) | undefined {
  if (!(card instanceof HTMLElement)) return undefined
  const pressed = (event: KeyboardEvent) => {
    if (event.altKey || event.ctrlKey || event.metaKey || event.defaultPrevented) return
    const far = event.shiftKey ? 1 : 0.1
    const on = event.target as HTMLElement
    if (event.key === ' ' && !on.closest('button, a, select, input:not([type=range])')) view.toggle()
    else if (event.key === 'ArrowLeft') view.steer({ step: -far })
    else if (event.key === 'ArrowRight') view.steer({ step: far })
    else if (event.key === 'Home') view.steer({ closest: true })
    else return
    event.preventDefault()
  }
  card.addEventListener('keydown', pressed)
  return () => card.removeEventListener('keydown', pressed)
}

/** The displayed flights, and the noise realisation of the chosen one. */
function flights(data: RunData, whatIf: boolean): string {
  const { finding, nominalTrace, findingTrace } = data
  const noise = noiseOf(finding ? findingTrace : nominalTrace)
  const which =
    !finding ? (nominalTrace ? 'Nominal alone' : 'Scenario') : `Nominal and ${calledOf(data).replace('Worst', 'worst')}`
  return [which, ...(noise ? [noise] : []), ...(whatIf ? ['what-if'] : [])].join(', ')
}
