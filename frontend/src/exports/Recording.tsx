// A flight as a recording: a link to the page that plays it, and a download. Neither needs a simulation.
import { IconCheck, IconCopy, IconDownload, IconPackage, IconPlayerPlay } from '@tabler/icons-react'
import { type Theme, useTheme } from '../theme/useTheme'
import { MenuItem } from '../overlay/later'
import { worded } from '../ui/Button'
import { Popup } from '../overlay/Popup'
import { at } from '../format/root'
import { EntryLines } from '../ui/EntryLines'
import { byHand, useCopy } from '../ui/files'

/** Where a recording of a flight, "F1" or "nominal", is played and downloaded. */
export const recordedAt = (run: string, flight: string, theme: Theme) => ({
  page: at(`/view/${run}/${flight}/recorded/${theme === 'dark' ? 'dark/' : ''}`),
  file: at(`/api/v1/runs/${run}/exports/flight-${flight}.html?theme=${theme}`),
})

interface Props {
  run: string
  flight: string
  /** The word for it: a simulator has cases. */
  one: 'flight' | 'case'
}

/** The button of the Flight card. */
export function RecordingMenu(props: Props) {
  return (
    <Popup
      kind="menu"
      width={300}
      button={worded(IconPlayerPlay, 'Recording', true)}
    >
      <RecordingEntries {...props} />
      {props.flight !== 'nominal' && <CapsuleEntry {...props} />}
    </Popup>
  )
}

/** Both actions as menu items. */
export function RecordingEntries({ run, flight, one }: Props) {
  const { page, file } = recordedAt(run, flight, useTheme())
  const called = flight === 'nominal' ? `the nominal ${one}` : flight
  return (
    <>
      <CopyLink address={page} />
      <MenuItem component="a" href={file} download leftSection={<IconDownload className="i s" aria-hidden />}>
        <EntryLines title="Download as one file">{called[0]?.toUpperCase() + called.slice(1)} in 3D with a play bar; works offline</EntryLines>
      </MenuItem>
    </>
  )
}

/** What evaluates the finding again elsewhere. */
function CapsuleEntry({ run, flight }: Props) {
  return (
    <MenuItem
      component="a"
      href={at(`/api/v1/runs/${run}/exports/capsule-${flight}.zip`)}
      download
      leftSection={<IconPackage className="i s" aria-hidden />}
    >
      <EntryLines title={`Capsule of ${flight}`}>Evaluated again with clearance replay FILE, without a service</EntryLines>
    </MenuItem>
  )
}

/** How long a copy is confirmed [ms]. */
const SHOWN = 10_000

/** The menu stays open to confirm the copy. */
function CopyLink({ address }: { address: string }) {
  const link = new URL(address, location.origin).href
  const { outcome, copy } = useCopy(SHOWN)
  return (
    <MenuItem
      closeMenuOnClick={false}
      onClick={() => void copy(link)}
      leftSection={outcome === 'copied' ? <IconCheck className="i s" aria-hidden /> : <IconCopy className="i s" aria-hidden />}
    >
      <EntryLines title="Copy link to the recording" live>
        {outcome === 'copied' ? 'Copied' : outcome ? byHand(link) : 'Requires a login; plays without a simulation'}
      </EntryLines>
    </MenuItem>
  )
}
