// The audit trail of a run, collapsed by default.
import { queryOptions, useQuery } from '@tanstack/react-query'
import { useState } from 'react'
import { getHistory } from '../../api/calls'
import { viaOf } from '../../format/people'
import { moment } from '../../format/time'
import { Failed } from '../../page/Trouble'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { Table } from '../../ui/Table'
import { statementOf } from './entry'
import { layout } from '../../ui/styles'

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
        <Button small aria-expanded={open} onClick={() => setOpen(!open)}>{open ? 'Hide' : 'Show'}</Button>
      }
    >
      {open && !data && !error && <p className="mut">Loading the history …</p>}
      {open && !data && error && <Failed error={error} retry={() => void refetch()} />}
      {open && data && (
        <Table
          rows={data}
          columns={[
            { head: 'When', width: 190, tone: 'sec nw', cell: ({ at }) => moment(at) },
            {
              head: 'User',
              width: 160,
              tone: 'nw',
              cell: (entry) => (
                <>
                  {entry.account} <span className="mut small">{viaOf(entry)}</span>
                </>
              ),
            },
            { head: 'What', cell: statementOf },
          ]}
        />
      )}
    </Card>
  )
}
