// The Export menu of a run's page: every file that the service makes of it, saved by the browser as it streams.
import { Menu } from '@mantine/core'
import { IconBraces, IconDownload, IconFileText, IconMatrix, IconTable } from '@tabler/icons-react'
import { queryOptions, useQuery } from '@tanstack/react-query'
import { useState } from 'react'
import { getExports } from '../api/calls'
import type { ExportFile, RunDetail } from '../client'

const exportsQuery = (id: string, state: string) =>
  queryOptions({ queryKey: ['exports', id, state], queryFn: () => getExports(id) })

export function ExportMenu({ run }: { run: RunDetail }) {
  const [opened, setOpened] = useState(false)
  const { data, error } = useQuery({ ...exportsQuery(run.id, run.state), enabled: opened })
  return (
    <Menu opened={opened} onChange={setOpened} position="bottom-end" width={340}>
      <Menu.Target>
        <button type="button" className="btn">
          <IconDownload className="i s" aria-hidden />
          Export
        </button>
      </Menu.Target>
      <Menu.Dropdown>
        <Menu.Label>Files of {run.id}</Menu.Label>
        {data?.map((file) => (
          <Entry key={file.href} file={file} />
        ))}
        {!data && <Menu.Item disabled>{error ? error.message : 'Asking what there is …'}</Menu.Item>}
        <Menu.Divider />
        <p className="small mut" style={{ padding: '4px 12px 8px' }}>
          Figures: the picture button of each chart saves it as PNG or SVG.
        </p>
      </Menu.Dropdown>
    </Menu>
  )
}

const ICONS: Record<string, typeof IconTable> = {
  'application/json': IconBraces,
  'text/csv': IconTable,
  'application/x-matlab-data': IconMatrix,
}

function Entry({ file }: { file: ExportFile }) {
  const Icon = ICONS[file.media_type] ?? IconFileText
  return (
    <Menu.Item
      component="a"
      href={file.unavailable ? undefined : file.href}
      download={file.name}
      disabled={file.unavailable !== null}
      leftSection={<Icon className="i s" aria-hidden />}
    >
      <span className="b">{file.title}</span>
      <span className="small mut" style={{ display: 'block', whiteSpace: 'normal' }}>
        {file.unavailable ?? file.text}
      </span>
    </Menu.Item>
  )
}
