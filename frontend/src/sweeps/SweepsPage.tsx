// The list of sweeps.
import { IconPlus } from '@tabler/icons-react'
import { queryOptions, useQuery } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import { listSweeps } from '../client'
import { count } from '../format/numbers'
import { launchedBy } from '../format/people'
import { moment, when } from '../format/time'
import { PageHead } from '../page/PageHead'
import { Unloaded } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { ButtonLink } from '../ui/Button'
import { Card } from '../ui/Card'
import { Table } from '../ui/Table'
import { statementOf } from './states'
import { layout, tables } from '../ui/styles'

const sweepsQuery = queryOptions({ queryKey: ['sweeps'], queryFn: () => listSweeps() })

export function SweepsPage() {
  useTitle('Sweeps')
  const query = useQuery(sweepsQuery)
  if (!query.data) return <Unloaded query={query} what="sweeps" title="Sweeps" />
  const { data } = query
  return (
    <>
      <PageHead title="Sweeps">
        <ButtonLink main icon={IconPlus} to="/launch">New run or sweep</ButtonLink>
      </PageHead>
      <Card title="All sweeps" note="One campaign with several values of a fixed parameter" flush={data.length > 0}>
        {data.length === 0 && (
          <p className="sec">
            There are no sweeps yet. Start one from the card “Sweep” of a <Link to="/launch">new run</Link>, or with <code>clearance submit FILE --sweep</code>.
          </p>
        )}
        {data.length > 0 && (
          <Table
            stack
            rows={data}
            columns={[
              {
                head: 'Sweep',
                cell: ({ id, name, campaign_name, code_warning }) => (
                  <span className={tables.rn}>
                    <Link to="/sweeps/$id" params={{ id }}>
                      {name}
                    </Link>
                    <small>
                      {id}
                      {campaign_name !== name && ` · ${campaign_name}`}
                    </small>
                    {code_warning && <small>{code_warning}</small>}
                  </span>
                ),
              },
              { head: 'Parameter', label: 'Parameter', tone: 'sec', cell: ({ path }) => path },
              { head: 'Runs', num: true, label: 'Runs', cell: ({ runs }) => count(runs) },
              { head: 'State', label: 'State', tone: 'sec nw', cell: ({ states }) => statementOf(states) },
              { head: 'User', label: 'User', className: layout.hideS, tone: 'sec', cell: launchedBy },
              { head: 'Submitted', label: 'Submitted', tone: 'sec nw', tip: ({ created }) => moment(created), cell: ({ created }) => when(created) },
            ]}
          />
        )}
      </Card>
    </>
  )
}
