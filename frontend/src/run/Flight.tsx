// The flight in 3D: the viewer runs in a frame of its own; every number it shows stands on this page too.
import { IconExternalLink, IconLoader } from '@tabler/icons-react'
import { useIsFetching } from '@tanstack/react-query'
import { useEffect, useRef, useState } from 'react'
import { RecordingMenu } from '../exports/Recording'
import { useTheme } from '../theme/useTheme'
import { Card } from '../ui/Card'
import { calledOf, NOMINAL } from './chosen'
import type { RunData } from './data'

export function Flight({ data, className }: { data: RunData; className: string }) {
  const theme = useTheme()
  const holder = useRef<HTMLDivElement>(null)
  const [near, setNear] = useState(false)
  const calm = useCalm()
  const [loaded, setLoaded] = useState(false)
  // The worst flight is the viewer's own choice: one address, one kept page.
  const shown = data.chosen === 'F1' ? '' : `${data.chosen}/`
  const address = `/view/${data.run.id}/${shown}${theme}/`

  // A viewer costs the service a scene: it is opened when it comes near the window.
  useEffect(() => {
    const element = holder.current
    if (!element || near) return
    const observer = new IntersectionObserver(([entry]) => entry?.isIntersecting && setNear(true), {
      rootMargin: '200px',
    })
    observer.observe(element)
    return () => observer.disconnect()
  }, [near])

  return (
    <Card
      title="Flight"
      note={`${flights(data.chosen)}, with what-if sliders. Drag to turn, wheel to zoom. Vehicles not to scale`}
      className={className}
      id="flight"
      flush
      right={
        <>
          {data.traces.some((t) => t.name === data.chosen) && <RecordingMenu run={data.run.id} flight={data.chosen} />}
          <a className="btn s" href={address} target="_blank" rel="noreferrer">
            <IconExternalLink className="i s" aria-hidden /> Own window
          </a>
        </>
      }
    >
      <div className="flight" ref={holder}>
        {near && calm && <iframe key={address} src={address} title="Flight in 3D" onLoad={() => setLoaded(true)} />}
        {!loaded && (
          <div className="poster" role="status">
            <span className="row">
              <IconLoader className="i spin" aria-hidden /> Opening the 3D view
            </span>
          </div>
        )}
      </div>
    </Card>
  )
}

/** The viewer takes the window's thread for a second or two as it starts: what the page shows itself comes first. */
const CALM = 400

/** True once everything asked for has come and been drawn for a moment; stays true. */
function useCalm(): boolean {
  const fetching = useIsFetching() > 0
  const [calm, setCalm] = useState(false)
  useEffect(() => {
    if (fetching || calm) return
    const timer = setTimeout(() => setCalm(true), CALM)
    return () => clearTimeout(timer)
  }, [fetching, calm])
  return calm
}

const flights = (chosen: string): string =>
  chosen === NOMINAL ? 'Nominal alone' : `Nominal and ${chosen === 'F1' ? calledOf(chosen).toLowerCase() : chosen}`
