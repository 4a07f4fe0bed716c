// What has become of the findings since the baseline: each finding of either run, and what the policy says of it.
import {
  IconArrowDownRight,
  IconArrowUpRight,
  IconCircleCheck,
  IconCircleX,
  IconEqual,
  IconHelpCircle,
  IconSparkles,
} from '@tabler/icons-react'
import { Link } from '@tanstack/react-router'
import { clsx } from 'clsx'
import type { FindingChange, Regression } from '../../client'
import { decimalsFor, plain, signed } from '../../format/numbers'
import { sentence, words } from '../../format/spans'
import { Card, NumHead } from '../../ui/Card'
import { Spans } from '../../ui/Spans'
import type { RunData } from '../data/data'
import { useAddress } from '../data/useAddress'
import badges from '../../ui/badges.module.css'
import buttons from '../../ui/buttons.module.css'
import tables from '../../ui/tables.module.css'
import styles from './regression.module.css'

type Standing = FindingChange['standing']

const LOOK: Record<Standing, { word: string; tone: string; Icon: typeof IconEqual }> = {
  new: { word: 'New', tone: 'unk', Icon: IconSparkles },
  worse: { word: 'Worse', tone: 'bad', Icon: IconArrowDownRight },
  same: { word: 'Same', tone: 'que', Icon: IconEqual },
  better: { word: 'Better', tone: 'ok', Icon: IconArrowUpRight },
  fixed: { word: 'Fixed', tone: 'ok', Icon: IconCircleCheck },
  'not compared': { word: 'Not compared', tone: 'unk', Icon: IconHelpCircle },
}

/** The name of a run: a folder of results has no page. */
const RUN = /^R-\d+$/

interface SinceProps {
  data: Pick<RunData, 'run'>
  className: string | undefined
}

export function SinceCard({ data, className }: SinceProps) {
  const { run } = data
  const [, change] = useAddress(run.id)
  const regression = run.summary?.regression
  if (!regression && !run.baseline) return null
  if (!regression) {
    const why = run.baseline?.run ? ' The run has no verdict, so nothing was compared.' : ''
    return <Without sentence={`${run.baseline?.sentence ?? ''}${why}`} className={className} />
  }
  return (
    <Card
      title="Since the baseline"
      note={<>Each finding of either run, matched by basin. Margins are to the threshold of this run</>}
      className={className}
      id="since"
      flush
      right={<Policy regression={regression} />}
      footer={<Told regression={regression} />}
    >
      <Changes unit={run.unit} regression={regression} choose={(label) => change({ finding: label === 'F1' ? undefined : label })} />
    </Card>
  )
}

function Without({ sentence: told, className }: { sentence: string; className: string | undefined }) {
  return (
    <Card title="Since the baseline" className={className} id="since">
      <p className="sec">{told}</p>
    </Card>
  )
}

function Policy({ regression: { ok } }: { regression: Regression }) {
  return (
    <span className={badges.vd} data-tone={ok ? 'ok' : 'bad'} data-testid="policy">
      {ok ? <IconCircleCheck className="i" aria-hidden /> : <IconCircleX className="i" aria-hidden />}
      {ok ? 'Policy holds' : 'Policy fails'}
    </span>
  )
}

function Told({ regression }: { regression: Regression }) {
  const lost = regression.cases.filter(({ standing }) => standing === 'not compared')
  const asked = regression.fail_on.map((word) => word.replace('_', ' ')).join(', ')
  return (
    <>
      <Spans spans={regression.statement} /> {lost.map((each, i) => <Spans key={i} spans={[...sentence(each.statement), words(' ')]} />)}
      {asked ? `The policy fails on: ${asked}.` : 'The policy fails on nothing.'} A finding that is new may also be one that
      the search of the baseline missed.
    </>
  )
}

interface ChangesProps {
  unit: string
  regression: Regression
  /** Shows a finding of this run in the other cards. */
  choose: (label: string) => void
}

export function Changes({ unit, regression, choose }: ChangesProps) {
  const { cases } = regression
  const decimals = decimalsFor(cases.flatMap((c) => [c.margin_before ?? null, c.margin_again ?? null, c.margin ?? null]), 5)
  const changes = cases.flatMap((c) => (c.change ? [c.change] : []))
  // A change that is not 0 is not shown as 0, down to a millionth.
  const smallest = Math.min(6, Math.max(3, ...changes.map((value) => decimalsFor([value], 2))))
  const named = RUN.test(regression.run) ? (
    <Link to="/runs/$id" params={{ id: regression.run }} className="mono">
      {regression.run}
    </Link>
  ) : (
    <span className={styles.folder}>{regression.run}</span>
  )
  return (
    <table className={clsx(tables.table, tables.tight)}>
      <thead>
        <tr>
          <th>Change</th>
          <th>In {named}</th>
          <th>Here</th>
          <NumHead unit={unit} title="The margin in the baseline, to the threshold of this run">Margin there</NumHead>
          <NumHead unit={unit} title="The finding of the baseline, evaluated on this model">Same case here</NumHead>
          <NumHead unit={unit} title="The lowest margin known in its basin on this model">Lowest here</NumHead>
          <NumHead unit={unit}>Change</NumHead>
          <NumHead unit={unit} title="A change up to this is no change">Tolerance</NumHead>
        </tr>
      </thead>
      <tbody>
        {cases.map((change, i) => (
          <Row key={i} choose={choose} change={change} decimals={decimals} smallest={smallest} />
        ))}
      </tbody>
    </table>
  )
}

interface RowProps extends Pick<ChangesProps, 'choose'> {
  change: FindingChange
  decimals: number
  smallest: number
}

function Row({ choose, change, decimals, smallest }: RowProps) {
  const { word, tone, Icon } = LOOK[change.standing]
  const parameters = Object.entries(change.parameters).map(([path, value]) => `${path} = ${plain(value, 9)}`)
  const margin = (value: number | null | undefined) => (
    <td className={value != null && value <= 0 ? 'num b bad-t' : 'num'}>{signed(value ?? null, decimals)}</td>
  )
  return (
    <tr data-standing={change.standing} title={parameters.join('\n')}>
      <td>
        <span className={badges.vd} data-tone={tone}>
          <Icon className="i" aria-hidden />
          {word}
        </span>{' '}
        {change.fails && <span className={clsx('small bad-t', styles.fails)}>fails</span>}
      </td>
      <td className="mono">{change.before ?? <span className="mut">none</span>}</td>
      <td>
        {change.now ? (
          <button type="button" className={clsx(buttons.linkbtn, 'mono')} onClick={() => choose(change.now ?? '')} title={`Show ${change.now}`}>
            {change.now}
          </button>
        ) : (
          <span className="mut">no finding</span>
        )}
      </td>
      {margin(change.margin_before)}
      {margin(change.margin_again)}
      {margin(change.margin)}
      <td className="num b">{signed(change.change ?? null, smallest)}</td>
      <td className="num mut">{plain(change.tolerance ?? null, 2)}</td>
    </tr>
  )
}
