// The Export menu of a run's page: all export files, saved by the browser as they stream.
import { IconBraces, IconDownload, IconFileText, IconFileTypePdf, IconMatrix, IconPackage, IconPlane, IconTable } from '@tabler/icons-react'
import { queryOptions, useMutation, useQuery } from '@tanstack/react-query'
import { useEffect, useRef, useState } from 'react'
import { getFile } from '../api/calls'
import { asCampaign, caseWord } from '../api/campaign'
import { type ExportFile, listExports, type RunDetail } from '../client'
import { MenuDivider, MenuItem, MenuLabel } from '../overlay/later'
import { ButtonAnchor, worded } from '../ui/Button'
import { Popup } from '../overlay/Popup'
import { save } from '../ui/files'
import { RecordingEntries } from './Recording'
import { at } from '../format/root'
import { EntryLines } from '../ui/EntryLines'
import styles from './exports.module.css'

/** The address of a recording, and its flight. */
const RECORDING = /\/exports\/flight-(\w+)\.html$/

const exportsQuery = (id: string, state: string) =>
  queryOptions({ queryKey: ['exports', id, state], queryFn: () => listExports({ path: { run: id } }) })

export function ExportMenu({ run }: { run: RunDetail }) {
  const [opened, setOpened] = useState(false)
  const { data, error } = useQuery({ ...exportsQuery(run.id, run.state), enabled: opened })
  const list = useListFocus(opened, data)
  const recording = data?.find((file) => RECORDING.test(file.href) && file.unavailable === null)
  const files = data?.filter((file) => file.media_type !== 'application/pdf' && !RECORDING.test(file.href))
  const one = caseWord(asCampaign(run.campaign))
  const pdf = data?.find((file) => file.media_type === 'application/pdf')
  return (
    <>
      {run.verdict && (
        <ButtonAnchor icon={IconFileText} href={at(`/api/v1/runs/${run.id}/report.html`)} target="_blank" rel="noreferrer">
          Safety-case report
        </ButtonAnchor>
      )}
      <Popup
        kind="menu"
        opened={opened}
        onChange={setOpened}
        width={340}
        dropdown={{ className: styles.files, ref: list }}
        button={worded(IconDownload, 'Export')}
      >
        <MenuLabel>Files of {run.id}</MenuLabel>
        {pdf && <PdfEntry file={pdf} />}
        {files?.map((file) => (
          <Entry key={file.href} file={file} />
        ))}
        {recording && <MenuLabel>{one === 'flight' ? 'Flight' : 'Case'} in 3D</MenuLabel>}
        {recording && <RecordingEntries run={run.id} flight={RECORDING.exec(recording.href)?.[1] ?? 'nominal'} one={one} />}
        {/* Not `disabled`: it holds the focus of the menu until the files are there. */}
        {!data && <MenuItem data-disabled closeMenuOnClick={false}>{error ? error.message : 'Loading the list of files …'}</MenuItem>}
        <MenuDivider />
        <p className="small mut" style={{ padding: '4px 12px 8px' }}>
          Figures: the picture button of each chart saves it as PNG or SVG.
        </p>
      </Popup>
    </>
  )
}

/** Of a menu whose items come later: the focus, which the line of loading had, goes to the first of them. */
function useListFocus(opened: boolean, data: unknown) {
  const list = useRef<HTMLDivElement>(null)
  useEffect(() => {
    const lost = document.activeElement === document.body
    if (opened && data && lost) list.current?.querySelector<HTMLElement>('[data-menu-item]:not([data-disabled])')?.focus()
  }, [opened, data])
  return list
}

/** The PDF is printed on request, which takes a few seconds and can fail: the menu stays open and reports it. */
function PdfEntry({ file }: { file: ExportFile }) {
  const print = useMutation({
    mutationFn: () => getFile(file.href),
    onSuccess: (blob) => save(file.name, blob),
  })
  const words = print.isPending ? 'Printing, a few seconds …' : (file.unavailable ?? file.text)
  return (
    <MenuItem
      closeMenuOnClick={false}
      disabled={file.unavailable !== null || print.isPending}
      onClick={() => print.mutate()}
      leftSection={<IconFileTypePdf className="i s" aria-hidden />}
    >
      <EntryLines title={file.title} live>{print.isError ? <span className="bad-t">{print.error.message}</span> : words}</EntryLines>
    </MenuItem>
  )
}

const ICONS: Record<string, typeof IconTable> = {
  'application/json': IconBraces,
  'text/csv': IconTable,
  'application/x-matlab-data': IconMatrix,
  'application/x-mcap': IconPlane,
  'application/vnd.apache.parquet': IconTable,
  'application/zip': IconPackage,
}

function Entry({ file }: { file: ExportFile }) {
  const Icon = ICONS[file.media_type] ?? IconFileText
  return (
    <MenuItem
      component="a"
      href={file.unavailable ? undefined : file.href}
      download={file.media_type === 'text/html' ? undefined : file.name}
      target={file.media_type === 'text/html' ? '_blank' : undefined}
      disabled={file.unavailable !== null}
      leftSection={<Icon className="i s" aria-hidden />}
    >
      <EntryLines title={file.title}>{file.unavailable ?? file.text}</EntryLines>
    </MenuItem>
  )
}
