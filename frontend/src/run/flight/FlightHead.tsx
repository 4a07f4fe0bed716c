// What stands in the head of the Flight card: from where to look, and what to do with the instant that is shown.
import {
  IconArrowsMaximize,
  IconCheck,
  IconExternalLink,
  IconLink,
} from '@tabler/icons-react'
import { useEffect, useState } from 'react'
import type { ViewState } from '../../client'
import { RecordingMenu } from '../../exports/Recording'
import { fixed } from '../../format/numbers'
import type { Theme } from '../../theme/useTheme'
import { Seg } from '../../ui/Card'
import { IconButton } from '../../ui/IconButton'
import type { RunData } from '../data/data'
import type { View } from './view'
import { addressOf, CAMERAS, type Camera, type Place } from '../data/viewChange'

interface Props {
  data: RunData
  view: View
  shown: ViewState | null
  theme: Theme
  onFull: () => void
}

export function FlightHead({ data, view, shown, theme, onFull }: Props) {
  const recorded = data.traces.some((trace) => trace.name === data.chosen)
  const own = addressOf(data.run.id, { flight: shown?.flight ?? data.chosen, theme }, placeOf(shown))
  return (
    <div className="row flight-head">
      <Seg
        label="Camera"
        value={(shown?.camera ?? '') as Camera}
        options={CAMERAS.map((camera) => ({ value: camera, label: `${camera.charAt(0).toUpperCase()}${camera.slice(1)}` }))}
        onChange={(camera) => view.steer({ camera })}
      />
      <span className="row" style={{ gap: 4 }}>
        <CopyInstant view={view} />
        <a
          className="iconbtn bd"
          href={own}
          target="_blank"
          rel="noreferrer"
          aria-label="Own window"
          title="This instant in a window of its own"
        >
          <IconExternalLink className="i s" aria-hidden />
        </a>
        <IconButton label="Full screen" icon={IconArrowsMaximize} act={onFull} />
      </span>
      {recorded && <RecordingMenu run={data.run.id} flight={data.chosen} />}
    </div>
  )
}

const placeOf = (shown: ViewState | null): Place =>
  shown ? { time: Number(shown.time.toFixed(2)), ...(shown.camera && { camera: shown.camera }) } : {}

/** The run's page at the instant that the view shows now. */
function linkTo(run: string, shown: ViewState): string {
  const { camera } = shown
  const query = new URLSearchParams({ finding: shown.flight, t: shown.time.toFixed(2), ...(camera && { cam: camera }) })
  return `${location.origin}/runs/${run}?${query.toString()}`
}

function CopyInstant({ view }: { view: View }) {
  const [said, setSaid] = useState('')
  useEffect(() => {
    if (!said) return
    const timer = setTimeout(() => setSaid(''), 4000)
    return () => clearTimeout(timer)
  }, [said])
  const copy = async () => {
    const shown = await view.look()
    if (!shown) return setSaid('The 3D view is not open yet')
    const link = linkTo(view.run, shown)
    return navigator.clipboard.writeText(link).then(
      () => setSaid(`Copied, at ${fixed(shown.time, 2)} s`),
      () => setSaid(`The browser does not let this page copy: ${link}`),
    )
  }
  return (
    <>
      <button
        type="button"
        className="iconbtn bd"
        aria-label="Copy link to this instant"
        title="Copy link to this instant"
        onClick={() => void copy()}
      >
        {said.startsWith('Copied') ? <IconCheck className="i s" aria-hidden /> : <IconLink className="i s" aria-hidden />}
      </button>
      <span className="small sec said" role="status">
        {said}
      </span>
    </>
  )
}
