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
import { clsx } from 'clsx'
import type { FindingChange, Regression } from '../../client'
import { decimalsFor, margin, plain } from '../../format/numbers'
import { sentence, words } from '../../format/spans'
import { TextButton } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { RunLink } from '../../ui/RunLink'
import { Spans } from '../../ui/Spans'
import { layout } from '../../ui/styles'
import { type Column, Table } from '../../ui/Table'
import type { RunData } from '../data/data'
import { worstOf } from '../data/chosen'
import { useAddress } from '../data/useAddress'
import styles from './regression.module.css'
import { Badge } from '../../ui/VerdictBadge'

type Standing = FindingChange['standing']

const LOOK: Record<Standing, { word: string; tone: string; Icon: typeof IconEqual }> = {
  new: { word: 'New', tone: 'unk', Icon: IconSparkles },
  worse: { word: 'Worse', tone: 'bad', Icon: IconArrowDownRight },
  same: { word: 'Same', tone: 'que', Icon: IconEqual },
  better: { word: 'Better', tone: 'ok', Icon: IconArrowUpRight },
  fixed: { word: 'Fixed', tone: 'ok', Icon: IconCircleCheck },
  unresolved: { word: 'Unresolved', tone: 'unk', Icon: IconHelpCircle },
  'not compared': { word: 'Not compared', tone: 'unk', Icon: IconHelpCircle },
}

/** The name of a run: a folder of results has no page. */
const RUN = /^R-\d+$/

export function SinceCard({ data }: { data: Pick<RunData, 'run'> }) {
  const { run } = data
  const [, change] = useAddress(run.id)
  const regression = run.summary?.regression
  if (!regression && !run.baseline) return null
  if (!regression) {
    const why = run.baseline?.run ? ' The run has no verdict, so nothing was compared.' : ''
    return <Without reason={`${run.baseline?.sentence ?? ''}${why}`} />
  }
  return (
    <Card
      title="Since the baseline"
      note={<>Each finding of either run, matched by basin. Margins are to the threshold of this run</>}
      className={layout.c12}
      id="since"
      flush
      right={<Policy regression={regression} />}
      footer={<Conclusion regression={regression} />}
    >
      <Changes unit={run.unit} regression={regression} choose={(label) => change({ finding: label === worstOf(run) ? undefined : label })} />
    </Card>
  )
}

function Without({ reason }: { reason: string }) {
  return (
    <Card title="Since the baseline" className={layout.c12} id="since">
      <p className="sec">{reason}</p>
    </Card>
  )
}

function Policy({ regression: { ok } }: { regression: Regression }) {
  return (
    <Badge tone={ok ? 'ok' : 'bad'} Icon={ok ? IconCircleCheck : IconCircleX} data-testid="policy">
      {ok ? 'Policy holds' : 'Policy fails'}
    </Badge>
  )
}

function Conclusion({ regression }: { regression: Regression }) {
  const lost = regression.cases.filter(({ standing }) => standing === 'not compared' || standing === 'unresolved')
  const policy = regression.fail_on.map((word) => word.replace('_', ' ')).join(', ')
  return (
    <>
      <Spans spans={regression.statement} /> {lost.map((each, i) => <Spans key={i} spans={[...sentence(each.statement), words(' ')]} />)}
      {policy ? `The policy fails on: ${policy}.` : 'The policy accepts every change.'} The search of the baseline may have
      missed a finding that is new.
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
  const named = RUN.test(regression.run) ? <RunLink run={regression.run} className="mono" /> : <span className={clsx(layout.wrapAny, styles.folder)}>{regression.run}</span>
  const column = (key: 'margin_before' | 'margin_again' | 'margin', head: string, title: string): Column<FindingChange> => ({
    head,
    title,
    unit,
    tone: ({ [key]: value }) => value != null && value <= 0 && 'b bad-t',
    cell: ({ [key]: value }) => margin(value ?? null, decimals),
  })
  return (
    <Table
      tight
      rows={cases}
      row={({ standing, parameters }) => ({ 'data-standing': standing, title: parametersText(parameters) })}
      columns={[
        { head: 'Change', cell: (change) => <Status change={change} /> },
        { head: <>In {named}</>, tone: 'mono', cell: ({ before }) => before ?? <span className="mut">none</span> },
        { head: 'Here', cell: ({ now }) => <Here now={now} choose={choose} /> },
        column('margin_before', 'Margin there', 'The margin in the baseline, to the threshold of this run'),
        column('margin_again', 'Same case here', 'The finding of the baseline, evaluated on this model'),
        column('margin', 'Lowest here', 'The lowest margin known in its basin on this model'),
        { head: 'Change', unit, tone: 'b', cell: ({ change }) => margin(change ?? null, smallest) },
        { head: 'Tolerance', unit, title: 'A change up to this is no change', tone: 'mut', cell: ({ tolerance }) => plain(tolerance ?? null, 2) },
      ]}
    />
  )
}

const parametersText = (parameters: FindingChange['parameters']): string =>
  Object.entries(parameters).map(([path, value]) => `${path} = ${plain(value, 9)}`).join('\n')

function Status({ change: { standing, fails } }: { change: FindingChange }) {
  const { word, tone, Icon } = LOOK[standing]
  return (
    <>
      <Badge tone={tone} Icon={Icon}>{word}</Badge>{' '}
      {fails && <span className={clsx('b small bad-t', styles.fails)}>fails</span>}
    </>
  )
}

function Here({ now, choose }: Pick<FindingChange, 'now'> & Pick<ChangesProps, 'choose'>) {
  if (!now) return <span className="mut">no finding</span>
  return (
    <TextButton className="mono" onClick={() => choose(now)} title={`Show ${now}`}>{now}</TextButton>
  )
}
