// The audit trail of a run, collapsed by default.
import { queryOptions, useQuery } from '@tanstack/react-query'
import { useState } from 'react'
import { getHistory } from '../../api/calls'
import { moment } from '../../format/time'
import { Card } from '../../ui/Card'
import { saidOf } from './said'

const historyQuery = (run: string) =>
  queryOptions({ queryKey: ['history', run], queryFn: () => getHistory(run), staleTime: 0 })

export function History({ run }: { run: string }) {
  const [open, setOpen] = useState(false)
  const { data, error } = useQuery({ ...historyQuery(run), enabled: open })
  return (
    <Card
      title="History"
      note="Who did what to this run"
      className="c12"
      id="history"
      flush={open && (data?.length ?? 0) > 0}
      right={
        <button type="button" className="btn s" aria-expanded={open} onClick={() => setOpen(!open)}>
          {open ? 'Hide' : 'Show'}
        </button>
      }
    >
      {open && error && <p className="ferr">{error.message}</p>}
      {open && data && (
        <table>
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
                  {entry.user} <span className="mut small">by {entry.via === 'link' ? 'login link' : entry.via}</span>
                </td>
                <td>{saidOf(entry)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </Card>
  )
}
