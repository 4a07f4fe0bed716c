// Comparison of the methods: results, effort, and how each ended.
import { clsx } from 'clsx'
import { LIMITS } from '../../api/rules'
import { resultOf } from '../../api/stages'
import type { Compared, Member } from '../../client'
import { count, decimalsApart, duration, fixed, NONE, percent, plain, signed } from '../../format/numbers'
import { words } from '../../format/spans'
import { HelpLink } from '../../help/links'
import { Card, NumHead, Progress } from '../../ui/Card'
import { MethodName } from '../../ui/MethodMark'
import { useMethodLook } from '../../ui/methods'
import { Spans } from '../../ui/Spans'
import { Sign } from '../../ui/Sign'
import { rateOf, type RunData, type SearchStage, searchesOf, stageOf } from '../data/data'
import layout from '../../ui/layout.module.css'
import tables from '../../ui/tables.module.css'
import styles from './search.module.css'

export function MethodsTable({ data, className, id }: { data: RunData; className: string | undefined; id?: string }) {
  const methodLook = useMethodLook()
  const { run } = data
  const searches = searchesOf(data)
  const bests = searches.map(({ stage }) => stage.best)
  const decimals = decimalsApart(bests, 4, 6)
  const best = Math.min(...bests.filter((value): value is number => value !== null))
  const over = searches.every(({ stage }) => stage.state === 'done')
  const failed = !over || searches.some(({ stage }) => stage.failed > 0)
  const excluded = searches.some(({ stage }) => stage.excluded > 0)
  const validation = resultOf(stageOf(data, 'validate'), 'validate')
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
      <table className={clsx(tables.table, tables.tight, styles.dense)}>
        <thead>
          <tr>
            <th>Method</th>
            {!over && <th>Budget used</th>}
            <th className="num">Evaluations</th>
            <NumHead unit={run.unit}>Best <Sign text={run.quantity || 'value'} /></NumHead>
            <NumHead unit={run.unit}>Above best</NumHead>
            {whole && <NumHead unit={run.unit} className={layout.hideN}>Margin</NumHead>}
            <NumHead unit="evaluation">Best at</NumHead>
            {compared && (
              <>
                <NumHead unit="at evaluation">Within {percent(LIMITS.same_cost, 1)}</NumHead>
                <NumHead unit={`of ${data.findings.length}`}>Findings</NumHead>
                <th title="The finding whose basin contains the method's best evaluation">Best is in</th>
              </>
            )}
            {failed && <th className="num">Failed</th>}
            {excluded && <th className="num">Excluded</th>}
            <th className="num">Time</th>
            <NumHead unit="1/s" title="Evaluations per second of its time" className={layout.hideN}>Rate</NumHead>
          </tr>
        </thead>
        <tbody>
          {searches.map(({ stage, title }) => (
            <tr key={stage.position} data-method={stage.method}>
              <td>
                <MethodName method={stage.method} title={title} />
              </td>
              {!over && (
                <td style={{ width: 110 }}>
                  <Progress
                    share={stage.evaluations / Math.max(1, stage.planned)}
                    colour={`var(${methodLook(stage.method).colour})`}
                    label={`${title}, share of its budget`}
                  />
                </td>
              )}
              <td className="num sec">{count(stage.evaluations)}</td>
              <td className={stage.best === best ? 'num b' : 'num'}>{fixed(stage.best, decimals)}</td>
              <td className="num sec">
                {stage.best === null ? NONE : stage.best === best ? 'best' : signed(stage.best - best, decimals)}
              </td>
              {whole && (
                <td className={clsx(layout.hideN, 'num sec')}>
                  {stage.best === null || run.threshold === null ? NONE : signed(stage.best - run.threshold, decimals)}
                </td>
              )}
              <td className="num sec">{stage.best_index === null ? NONE : count(stage.best_index + 1)}</td>
              {compared && (
                <Reached row={compared.find((c) => c.position === stage.position)} basins={validation?.encounter !== null} />
              )}
              {failed && <td className={stage.failed > 0 ? 'num b' : 'num sec'}>{count(stage.failed)}</td>}
              {excluded && <td className={stage.excluded > 0 ? 'num b' : 'num sec'}>{count(stage.excluded)}</td>}
              <td className="num sec" title={stage.state === 'waiting' ? undefined : `${plain(stage.seconds)} s`}>
                {stage.state === 'waiting' ? NONE : duration(stage.seconds)}
              </td>
              <td className={clsx(layout.hideN, 'num sec')} title={`${count(stage.evaluations)} evaluations in ${plain(stage.seconds)} s`}>
                {plain(rateOf(stage), 3)}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </Card>
  )
}

/** Evaluations until a method was near the best known value, and how many findings it found independently. */
function Reached({ row, basins }: { row: Compared | undefined; basins: boolean }) {
  return (
    <>
      <td className="num sec">{row?.to_near_best == null ? 'not reached' : count(row.to_near_best)}</td>
      <td className="num sec" title={row?.findings.join(', ')}>
        {count(row?.findings.length)}
      </td>
      <td className={row?.basin ? 'sec' : 'unk-t'}>{basinText(row, basins)}</td>
    </>
  )
}

/** The finding whose basin contains a method's best. Earlier versions stored neither basins nor the encounter. */
export function basinText(row: Pick<Compared, 'basin'> | undefined, basins: boolean): string {
  return row && basins ? (row.basin ?? 'no finding') : NONE
}

/** Evaluations of each member of a portfolio. */
const membersText = (members: Member[]): string =>
  members.map((member) => `${member.title} ${count(member.evaluations)}`).join(', ')

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
