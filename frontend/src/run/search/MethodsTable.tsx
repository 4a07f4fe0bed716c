// Comparison of the methods: results, effort, and how each ended.
import { LIMITS } from '../../api/rules'
import { resultWith } from '../../api/stages'
import type { Compared, Member } from '../../client'
import { count, decimalsApart, duration, fixed, margin, NONE, percent, plain, signed } from '../../format/numbers'
import { words } from '../../format/spans'
import { HelpLink } from '../../help/links'
import { Card, Progress } from '../../ui/Card'
import { MethodName } from '../../ui/MethodMark'
import { useMethodLook } from '../../ui/methods'
import { Spans } from '../../ui/Spans'
import { Sign } from '../../ui/Sign'
import { type Column, Table } from '../../ui/Table'
import { rateOf, type RunData, type SearchStage, searchesOf } from '../data/data'
import { layout } from '../../ui/styles'
import styles from './search.module.css'

export function MethodsTable({ data, className, id }: { data: RunData; className?: string; id?: string }) {
  const methodLook = useMethodLook()
  const { run } = data
  const searches = searchesOf(data)
  const bests = searches.map(({ stage }) => stage.best)
  const decimals = decimalsApart(bests, 4, 6)
  const best = Math.min(...bests.filter((value): value is number => value !== null))
  const over = searches.every(({ stage }) => stage.state === 'done')
  const failed = !over || searches.some(({ stage }) => stage.failed > 0)
  const excluded = searches.some(({ stage }) => stage.excluded > 0)
  const validation = resultWith(data.stages, 'comparison')
  const compared = validation && validation.comparison.length > 0 ? validation.comparison : null
  // With findings there is no room for the margin, which follows from the best value.
  const whole = !compared && !(over && (failed || excluded))
  return (
    <Card
      title="Methods"
      note={over ? 'What each found on its own' : 'One after another'}
      className={className}
      id={id}
      flush
      right={<HelpLink to="/help/methods">What each method does</HelpLink>}
      footer={over ? <Ends searches={searches} /> : undefined}
    >
      <Table
        tight
        className={styles.dense}
        rows={searches}
        row={({ stage }) => ({ 'data-method': stage.method })}
        columns={[
          { head: 'Method', cell: ({ stage, title }) => <MethodName method={stage.method} title={title} /> },
          !over && {
            head: 'Budget used',
            width: 110,
            cell: ({ stage, title }) => (
              <Progress
                share={stage.evaluations / Math.max(1, stage.planned)}
                colour={`var(${methodLook(stage.method).colour})`}
                label={`${title}, fraction of its budget`}
              />
            ),
          },
          { head: 'Evaluations', num: true, tone: 'sec', cell: ({ stage }) => count(stage.evaluations) },
          {
            head: <>Best <Sign text={run.quantity || 'value'} /></>,
            unit: run.unit,
            tone: ({ stage }) => stage.best === best && 'b',
            cell: ({ stage }) => fixed(stage.best, decimals),
          },
          {
            head: 'Above best',
            unit: run.unit,
            tone: 'sec',
            cell: ({ stage }) => (stage.best === null ? NONE : stage.best === best ? 'best' : signed(stage.best - best, decimals)),
          },
          whole && {
            head: 'Margin',
            unit: run.unit,
            className: layout.hideN,
            tone: 'sec',
            cell: ({ stage }) => (stage.best === null || run.threshold === null ? NONE : margin(stage.best - run.threshold, decimals)),
          },
          { head: 'Best at', unit: 'evaluation', tone: 'sec', cell: ({ stage }) => (stage.best_index === null ? NONE : count(stage.best_index + 1)) },
          ...(compared ? comparedColumns(compared, data.findings.length, validation?.encounter !== null) : []),
          failed && lossColumn('Failed', 'failed'),
          excluded && lossColumn('Excluded', 'excluded'),
          {
            head: 'Time',
            num: true,
            tone: 'sec',
            tip: ({ stage }) => (stage.state === 'waiting' ? undefined : `${plain(stage.seconds)} s`),
            cell: ({ stage }) => (stage.state === 'waiting' ? NONE : duration(stage.seconds)),
          },
          {
            head: 'Rate',
            unit: '1/s',
            title: 'Evaluations per second of its time',
            className: layout.hideN,
            tone: 'sec',
            tip: ({ stage }) => `${count(stage.evaluations)} evaluations in ${plain(stage.seconds)} s`,
            cell: ({ stage }) => plain(rateOf(stage), 3),
          },
        ]}
      />
    </Card>
  )
}

const lossColumn = (head: string, key: 'failed' | 'excluded'): Column<SearchStage> => ({
  head,
  num: true,
  tone: ({ stage }) => (stage[key] > 0 ? 'b' : 'sec'),
  cell: ({ stage }) => count(stage[key]),
})

/** Evaluations until a method was near the best known value, and how many findings it found independently. */
function comparedColumns(compared: readonly Compared[], findings: number, basins: boolean): Column<SearchStage>[] {
  const of = ({ stage }: SearchStage) => compared.find(({ position }) => position === stage.position)
  const near = (row: Compared | undefined) => (row?.to_near_best == null ? 'not reached' : count(row.to_near_best))
  return [
    { head: `Within ${percent(LIMITS.same_cost, 1)}`, unit: 'at evaluation', tone: 'sec', cell: (search) => near(of(search)) },
    { head: 'Findings', unit: `of ${findings}`, tone: 'sec', tip: (search) => of(search)?.findings.join(', '), cell: (search) => count(of(search)?.findings.length) },
    {
      head: 'Best is in',
      title: "The finding whose basin contains the method's best evaluation",
      tone: (search) => (of(search)?.basin ? 'sec' : 'unk-t'),
      cell: (search) => basinText(of(search), basins),
    },
  ]
}

/** The finding whose basin contains a method's best. Earlier versions stored neither basins nor the encounter. */
export function basinText(row: Pick<Compared, 'basin'> | undefined, basins: boolean): string {
  return row && basins ? (row.basin ?? 'no finding') : NONE
}

/** Evaluations of each member of a portfolio, and which do not use the others' points. */
const membersText = (members: Member[]): string =>
  members.map((member) => `${member.title} ${count(member.evaluations)}${member.apart ? ' (apart)' : ''}`).join(', ')

/** The reason why each search ended. */
function Ends({ searches }: { searches: SearchStage[] }) {
  return searches.map(({ stage, title, result }) =>
    result?.stop ? (
      <div key={stage.position}>
        <span className="sec">{title}:</span> <Spans spans={result.stop.statement} />
        {result.members.length > 0 && `; ${membersText(result.members)}`}
        {result.gap && <Spans spans={[words('; '), ...result.gap.statement]} />}
      </div>
    ) : null,
  )
}
