// Other runs with the same input as a run, and those that differ in one thing, with links to compare.
import { IconArrowsDiff, IconChartDots } from '@tabler/icons-react'
import { queryOptions, useQuery } from '@tanstack/react-query'
import { listRelated, type RelatedRun, type RelatedRuns, type RunDetail } from '../client'
import { count } from '../format/numbers'
import { Failed } from '../page/Trouble'
import { ButtonLink } from '../ui/Button'
import { Card } from '../ui/Card'
import { buttonColumn, Table } from '../ui/Table'
import { useNearOrPrint } from '../ui/useNear'
import { CodeCell, DateCell, outcomeColumns } from './cells'
import { differenceOf } from './code'
import { layout } from '../ui/styles'

const relatedQuery = (run: string, state: string) =>
  queryOptions({ queryKey: ['related', run, state], queryFn: () => listRelated({ path: { run } }) })

export function RelatedCard({ run }: { run: RunDetail }) {
  const [card, near] = useNearOrPrint<HTMLElement>()
  const { data, error, refetch } = useQuery({ ...relatedQuery(run.id, run.state), enabled: near })
  const rows = data?.runs ?? []
  return (
    <Card
      title="Same input in other runs"
      note="The same campaign, or one that differs only in the seed or the code"
      className={layout.c12}
      id="related"
      ref={card}
      flush={rows.length > 0}
      right={
        <ButtonLink small icon={IconChartDots} to="/trends" search={{ campaign: run.campaign_digest }}>Trend</ButtonLink>
      }
      footer={
        data && (
          <>
            {data.total > rows.length && `The newest ${rows.length} of ${count(data.total)} runs. `}
            {askedAgain(data.question)}
            {data.against && ` ${data.against}`}
          </>
        )
      }
    >
      {!data && !error && <p className="mut">Loading other runs …</p>}
      {!data && error && <Failed error={error} retry={() => void refetch()} />}
      {data && rows.length === 0 && <p className="sec">No other run of this campaign is listed, with any seed.</p>}
      {rows.length > 0 && <Others own={run.id} rows={rows} />}
    </Card>
  )
}

const WITHOUT_VERDICT: Record<string, string> = {
  none: 'without a verdict',
  unconfirmed: 'without a verdict that found a value at or below the threshold',
}

/** How often the question was asked: whoever repeats a run until it is cleared is seen. */
function askedAgain(question: RelatedRuns['question']): string {
  const words = Object.entries(question).map(([word, n]) => `${count(n)} ${WITHOUT_VERDICT[word] ?? word}`)
  const runs = Object.values(question).reduce((sum, n) => sum + n, 0)
  if (runs === 0) return 'How often its question was asked is not known, because its campaign is of an earlier version.'
  if (runs < 2) return 'No other run asks the same question: the same system, bounds and criterion, at any threshold.'
  return `${count(runs)} runs ask the same question, removed ones included: ${words.join(', ')}.`
}

function Others({ own, rows }: { own: string; rows: readonly RelatedRun[] }) {
  return (
    <Table
      rows={rows}
      columns={[
        ...outcomeColumns(rows, { head: 'Differs in', tone: 'sec', cell: differenceOf }),
        { head: 'Code', cell: ({ code, unidentified }) => <CodeCell code={code} unidentified={unidentified} /> },
        { head: 'Finished', cell: (other) => <DateCell outcome={other} /> },
        buttonColumn<RelatedRun>(
          'Compare',
          ({ id }) => (
            <ButtonLink small icon={IconArrowsDiff} to="/compare" search={{ runs: `${own},${id}` }} aria-label={`Compare ${own} with ${id}`}>
              Compare
            </ButtonLink>
          ),
          '',
        ),
      ]}
    />
  )
}
