// The audit trail of a run, collapsed by default.
import { clsx } from 'clsx'
import { queryOptions, useQuery } from '@tanstack/react-query'
import { useState } from 'react'
import { getHistory } from '../../api/calls'
import { moment } from '../../format/time'
import { Failed } from '../../page/Trouble'
import { Card } from '../../ui/Card'
import { statementOf } from './entry'
import buttons from '../../ui/buttons.module.css'
import layout from '../../ui/layout.module.css'
import tables from '../../ui/tables.module.css'

const historyQuery = (run: string) =>
  queryOptions({ queryKey: ['history', run], queryFn: () => getHistory(run), staleTime: 0 })

export function History({ run }: { run: string }) {
  const [open, setOpen] = useState(false)
  const { data, error, refetch } = useQuery({ ...historyQuery(run), enabled: open })
  return (
    <Card
      title="History"
      note="Who did what to this run"
      className={layout.c12}
      id="history"
      flush={open && (data?.length ?? 0) > 0}
      right={
        <button type="button" className={clsx(buttons.btn, buttons.s)} aria-expanded={open} onClick={() => setOpen(!open)}>
          {open ? 'Hide' : 'Show'}
        </button>
      }
    >
      {open && !data && !error && <p className="mut">Loading the history …</p>}
      {open && !data && error && <Failed error={error} retry={() => void refetch()} />}
      {open && data && (
        <table className={tables.table}>
          <thead>
            <tr>
              <th style={{ width: 190 }}>When</th>
              <th style={{ width: 160 }}>User</th>
              <th>What</th>
            </tr>
          </thead>
          <tbody>
            {data.map((entry, i) => (
              <tr key={i}>
                <td className="sec nw">{moment(entry.at)}</td>
                <td className="nw">
                  {entry.user} <span className="mut small">by {{ link: 'login link', provider: 'single sign-on' }[entry.via] ?? entry.via}</span>
                </td>
                <td>{statementOf(entry)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </Card>
  )
}
