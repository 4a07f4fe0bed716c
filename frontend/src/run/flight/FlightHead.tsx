// The header of the Flight card: cameras, and actions on the displayed instant.
import {
  IconArrowsMaximize,
  IconCheck,
  IconExternalLink,
  IconLink,
} from '@tabler/icons-react'
import { Link } from '@tanstack/react-router'
import { clsx } from 'clsx'
import { caseWord, hasScenario } from '../../api/campaign'
import { isLive } from '../../api/queries'
import type { ViewState } from '../../client'
import { RecordingMenu } from '../../exports/Recording'
import { fixed } from '../../format/numbers'
import { Seg } from '../../ui/Card'
import { byHand, copied } from '../../ui/files'
import { IconButton } from '../../ui/IconButton'
import type { RunData } from '../data/data'
import { camerasOf } from './declared'
import type { View } from './view'
import { type Camera, shownPlace } from '../data/viewChange'
import { type ChosenSearch, NOMINAL, worstOf } from '../data/chosen'
import { useAddress } from '../data/useAddress'
import { ROOT } from '../../format/root'
import { Select } from '../../ui/Select'
import { buttons, layout } from '../../ui/styles'
import styles from './flight.module.css'
import { useBrief } from '../../ui/useBrief'

interface Props {
  data: RunData
  view: View
  shown: ViewState | null
  /** In its own window. */
  alone: boolean
  onCamera: (camera: Camera) => void
  onFull: () => void
}

/** It looks over an obstacle at the vehicle, whether the obstacle moves or not. */
const NAMES: Partial<Record<Camera, string>> = { intruder: 'Obstacle' }

export function FlightHead({ data, view, shown, alone, onCamera, onFull }: Props) {
  const flies = hasScenario(data.campaign)
  const recorded = data.traces.some(({ name, meta }) => name === data.chosen && (flies || meta.scene))
  const [address] = useAddress(data.run.id)
  const place = shownPlace(shown) ?? {}
  const { whatif, set, noise } = address
  return (
    <div className={clsx(layout.row, styles.flightHead)}>
      {alone && <Choice data={data} />}
      <Seg
        label="Camera"
        value={(shown?.camera ?? '') as Camera}
        options={Object.fromEntries(camerasOf(data).map((camera) => [camera, NAMES[camera] ?? camera.charAt(0).toUpperCase() + camera.slice(1)]))}
        onChange={onCamera}
      />
      <span className={layout.row} style={{ gap: 4 }}>
        <CopyInstant view={view} address={address} alone={alone} />
        {!alone && (
          <Link
            className={clsx(buttons.iconbtn, buttons.bd)}
            to="/runs/$id/flight"
            params={{ id: data.run.id }}
            search={{ whatif, set, noise, finding: data.chosen, t: place.time ?? address.t, cam: place.camera ?? address.cam }}
            target="_blank"
            preload={false}
            aria-label="Own window"
            title="This instant in its own window"
          >
            <IconExternalLink className="i s" aria-hidden />
          </Link>
        )}
        <IconButton label="Full screen" icon={IconArrowsMaximize} act={onFull} />
      </span>
      {recorded && <RecordingMenu run={data.run.id} flight={data.chosen} one={caseWord(data.campaign)} />}
    </div>
  )
}

/** The address of this page at the displayed instant, with its what-if. */
function linkTo(run: string, shown: ViewState, address: ChosenSearch, alone: boolean): string {
  const { camera } = shown
  const { whatif, set = [], noise } = address
  const query = new URLSearchParams({ finding: shown.flight, t: shown.time.toFixed(2), ...(camera && { cam: camera }) })
  if (whatif !== undefined) query.append('whatif', whatif)
  for (const value of set) query.append('set', value)
  if (noise !== undefined) query.append('noise', String(noise))
  return `${location.origin}${ROOT}/runs/${run}${alone ? '/flight' : ''}?${query.toString().replaceAll('%3A', ':')}`
}

/** Selects the flight shown with the nominal one. */
function Choice({ data }: { data: RunData }) {
  const [, change] = useAddress(data.run.id)
  // Of an active run, the worst case that it will find is chosen before there is one.
  const found = data.findings.map(({ label }) => label)
  const labels = found.length === 0 && isLive(data.run) ? [data.chosen] : found
  return (
    <Select
      label={caseWord(data.campaign) === 'flight' ? 'Flight shown' : 'Case shown'}
      value={labels.includes(data.chosen) ? data.chosen : NOMINAL}
      options={[...new Set([...labels, NOMINAL])].map((label) => ({
        value: label,
        label: label === NOMINAL ? 'Nominal alone' : label === worstOf(data.run) ? `Worst (${label})` : label,
      }))}
      onChange={(finding) => change({ finding })}
    />
  )
}

function CopyInstant({ view, address, alone }: { view: View; address: ChosenSearch; alone: boolean }) {
  const [statement, setStatement] = useBrief<string>(4000)
  const copy = async () => {
    const shown = await view.look()
    if (!shown) return setStatement('The 3D view is not open yet')
    const link = linkTo(view.run, shown, address, alone)
    setStatement((await copied(link)) ? `Copied, at ${fixed(shown.time, 2)} s` : byHand(link))
  }
  return (
    <>
      <IconButton label="Copy link to this instant" icon={statement?.startsWith('Copied') ? IconCheck : IconLink} act={() => void copy()} />
      <span className={clsx(styles.statement, 'small sec')} role="status">
        {statement}
      </span>
    </>
  )
}
