// All distinct worst cases with their evidence; the rest of the page shows the chosen one.
import { IconCircleCheck, IconHelpCircle } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { Fragment, type MouseEvent } from 'react'
import { hasScenario } from '../../api/campaign'
import { samplerOf } from '../../api/stages'
import type { FindingDetail, Gathered, Span } from '../../client'
import { count, decimalsApart, fixed, margin as marginText, NONE, percent } from '../../format/numbers'
import { sentence, words } from '../../format/spans'
import { unitText } from '../../format/units'
import { Card, NumHead } from '../../ui/Card'
import { MethodName } from '../../ui/MethodMark'
import { methodLook } from '../../ui/methods'
import { Spans } from '../../ui/Spans'
import { Sign } from '../../ui/Sign'
import { useHotkeys } from '../../ui/useHotkeys'
import { NOMINAL, worstOf } from '../data/chosen'
import { drawn, type RunData, type UncertainParameter, valuesOf } from '../data/data'
import { isLikely, LikelyCell, LikelySentence, MostLikelyRow, Places } from './Likely'
import { ModePicture } from './ModePicture'
import { useAddress } from '../data/useAddress'
import { validatedWord } from '../data/validated'
import { layout, tables } from '../../ui/styles'
import styles from './findings.module.css'

interface FindingsProps {
  data: RunData
  gathered: Gathered | null | undefined
}

export function FindingsCard({ data, gathered }: FindingsProps) {
  const { run, findings, finding: shown, parameters, chosen } = data
  const [, change] = useAddress(run.id)
  const choose = (name: string) => change({ finding: name === worstOf(run) ? undefined : name })
  const names = [...findings.map((finding) => finding.label), NOMINAL]
  const step = (by: number) => choose(names[Math.min(names.length - 1, Math.max(0, names.indexOf(chosen) + by))] ?? NOMINAL)
  useHotkeys({ j: () => step(1), k: () => step(-1) })
  const decimals = decimalsApart([run.nominal_cost, ...findings.flatMap(({ cost, granted }) => [cost, granted])], 4, 6)
  const shared = { data, decimals, choose }
  const flown = hasScenario(data.campaign)
  const likely = isLikely(findings)
  return (
    <Card
      title="Findings"
      note={`Distinct worst cases. The chosen one is shown in ${flown ? 'the flight, the table next to it and the separation' : 'the table above'}`}
      className={layout.c12}
      id="findings"
      flush
      footer={
        gathered && (
          <>
            <Boundary data={data} statement={shown?.boundary?.statement ?? []} />
            <LikelySentence data={data} />
            <Gathering gathered={gathered} kept={findings.length} />
          </>
        )
      }
    >
      <table className={clsx(tables.table, tables.tight, styles.pick)}>
        <thead>
          <tr>
            <th>Finding</th>
            {flown && <th>From above</th>}
            <NumHead unit={run.unit}><Sign text={run.quantity || 'value'} /></NumHead>
            <NumHead unit={run.unit}>Margin</NumHead>
            {likely && <NumHead unit="standard deviations" title="Distance from the most likely point of the stated distributions, and how many draws are no more likely">Likelihood</NumHead>}
            {flown && <NumHead unit="s">Closest at</NumHead>}
            {flown && <NumHead unit="m/s">Speed there</NumHead>}
            {run.criteria.slice(1).map((criterion) => (
              <NumHead key={criterion.name} unit={unitText(criterion.unit)} title={criterion.title}>
                <Sign text={criterion.quantity || criterion.title} />
              </NumHead>
            ))}
            {parameters.map((p) => (
              <th key={p.path} className={styles.place} title={`${p.text} [${unitText(p.unit)}]`}>
                <Sign text={p.symbol} path={p.path} />
              </th>
            ))}
            <th>At bounds</th>
            <th>Found by, after evaluations</th>
            <th>Validation</th>
          </tr>
        </thead>
        <tbody>
          {findings.map((finding) => (
            <Row key={finding.label} {...shared} of={finding} />
          ))}
          <MostLikelyRow data={data} decimals={decimals} between={(flown ? 2 : 0) + run.criteria.length - 1} />
          <Row {...shared} of={null} />
        </tbody>
      </table>
    </Card>
  )
}

interface RowProps {
  data: RunData
  decimals: number
  choose: (name: string) => void
  /** Null: the nominal case. */
  of: FindingDetail | null
}

function Row({ data, decimals, choose, of }: RowProps) {
  const { run, parameters } = data
  const name = of?.label ?? NOMINAL
  const on = name === data.chosen
  const cost = of ? of.granted : run.nominal_cost
  const margin = of ? of.margin : cost === null || run.threshold === null ? null : cost - run.threshold
  return (
    <tr {...picking(name, on, choose)} data-finding={name}>
      <Name name={name} on={on} choose={choose} />
      {hasScenario(data.campaign) && <Picture data={data} name={name} />}
      <td className={of ? 'num b' : 'num'}>
        {fixed(cost, decimals)}
        {of && of.granted !== of.cost && (
          <small className={clsx('mut nw', styles.evaluated)} title="What the search found. Another evaluation of this case is milder, and that one is stated.">
            evaluated {fixed(of.cost, decimals)}
          </small>
        )}
      </td>
      <td className={margin !== null && margin <= 0 ? 'num b bad-t' : 'num'}>{marginText(margin, decimals)}</td>
      {isLikely(data.findings) && (of ? <LikelyCell likelihood={of.likelihood} /> : <td />)}
      <Met data={data} name={name} values={of ? of.values : valuesOf(data.nominalTrace)} />
      {of ? (
        <>
          <Places of={of} parameters={parameters} />
          <td className="sec">
            <Bounds finding={of} parameters={parameters} />
          </td>
          <td>
            <FoundBy finding={of} stages={data.stages} />
          </td>
          <td className="nw">
            <Validated finding={of} />
          </td>
        </>
      ) : (
        <td colSpan={parameters.length + 3} className="mut small">
          Every parameter at its nominal value
        </td>
      )}
    </tr>
  )
}

/** A click on the row selects it; the button in it does the same by keyboard. */
const picking = (name: string, on: boolean, choose: (name: string) => void) => ({
  className: on ? styles.sel : undefined,
  onClick: (event: MouseEvent) => {
    if (!(event.target as HTMLElement).closest('button') && !getSelection()?.toString()) choose(name)
  },
})

function Name({ name, on, choose }: { name: string; on: boolean; choose: (name: string) => void }) {
  const nominal = name === NOMINAL
  return (
    <td>
      <button type="button" className={clsx('b', styles.picker)} aria-pressed={on} onClick={() => choose(name)}>
        <span className={styles.dot} style={{ background: nominal ? 'var(--c-nom)' : 'var(--c-worst)' }} />
        {nominal ? 'Nominal' : name}
      </button>
    </td>
  )
}

function Picture({ data, name }: { data: RunData; name: string }) {
  return (
    <td className={styles.pic}>
      <ModePicture run={data.run.id} name={name} stored={data.traces.some((trace) => trace.name === name)} />
    </td>
  )
}

/** Time and speed at the closest approach, and the values of the other criteria. */
function Met({ data, name, values }: { data: RunData; name: string; values: Record<string, number | null> }) {
  const { run, findings, nominalTrace } = data
  const closest = data.traces.find((trace) => trace.name === name)?.meta.closest
  return (
    <>
      {hasScenario(data.campaign) && (
        <>
          <td className="num sec">{fixed(closest?.time, 2)}</td>
          <td className="num sec">{fixed(closest?.speed, 2)}</td>
        </>
      )}
      {run.criteria.slice(1).map((criterion) => {
        const all = [valuesOf(nominalTrace), ...findings.map((finding) => finding.values)]
        return (
          <td key={criterion.name} className="num">
            {fixed(values[criterion.name], decimalsApart(all.map((each) => each[criterion.name]), 4, 6))}
          </td>
        )
      })}
    </>
  )
}

/** Up to three names, otherwise the number. */
function Bounds({ finding, parameters }: { finding: FindingDetail; parameters: UncertainParameter[] }) {
  const at = parameters.filter((p) => p.path in finding.at_bounds)
  if (at.length === 0) return 'none'
  if (at.length > 3) return `${at.length} of ${parameters.length}`
  return at.map((p, i) => (
    <Fragment key={p.path}>
      {i > 0 && ', '}
      <span className="nw">
        <Sign text={p.symbol} path={p.path} /> {finding.at_bounds[p.path]}
      </span>
    </Fragment>
  ))
}

export function FoundBy({ finding, stages }: { finding: FindingDetail; stages: RunData['stages'] }) {
  if (finding.found.length === 0)
    return <span className="sec">{drawn(finding) ? samplerOf(stages) : 'no search: refined from another point, or of another stage'}</span>
  const found = [...finding.found].sort((a, b) => a.evaluations - b.evaluations)
  return (
    <span className={styles.finders}>
      {found.map((by) => (
        <span key={by.position} className={clsx(layout.row, 'nw')} title={methodLook(by.method).title}>
          <MethodName method={by.method} short /> <span className="sec tn">{count(by.evaluations)}</span>
        </span>
      ))}
    </span>
  )
}

function Validated({ finding }: { finding: FindingDetail }) {
  const { validation } = finding
  if (!validation) return <span className="mut">{NONE}</span>
  const { ok, realisation } = validation
  const Icon = ok ? IconCircleCheck : IconHelpCircle
  return (
    <span className={tables.rn}>
      <span className={layout.row}>
        <Icon className={ok ? 'i s ok-t' : 'i s unk-t'} aria-hidden /> {validatedWord(validation)}
      </span>
      {realisation !== null && <small>noise seed {realisation}</small>}
    </span>
  )
}

/** The distance of the chosen violation's boundary from nominal. */
function Boundary({ data, statement }: { data: RunData; statement: readonly Span[] }) {
  return statement.length > 0 ? (
    <div>
      <span className="sec">Boundary of {data.chosen}:</span> <Spans spans={[...statement, words('.')]} />
    </div>
  ) : null
}

/** How the findings were distinguished, in one sentence. */
function Gathering({ gathered, kept }: { gathered: Gathered; kept: number }) {
  return (
    <>
      {!gathered.complete && <Spans spans={[...sentence(gathered.statement), words(' ')]} />}
      Local searches began at {count(gathered.candidates)} low points. Two results are one finding if no parameter differs by more
      than {percent(gathered.distance)} of its range, or if no barrier higher than {percent(gathered.barrier)} of nominal minus worst
      separates them.
      {gathered.left_out > 0 && ` ${count(gathered.left_out)} more were no worse than the nominal case and are omitted.`}
      {kept >= gathered.at_most && ` At most ${gathered.at_most} are stored: there may be more.`}
    </>
  )
}
