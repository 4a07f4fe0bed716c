// How likely findings are under the stated distributions, and the most likely violation that was evaluated.
import { useQuery } from '@tanstack/react-query'
import { hasScenario } from '../../api/campaign'
import { mostLikelyQuery } from '../../api/queries'
import type { FindingDetail, Likelihood, MostLikely } from '../../client'
import { fixed, margin, NONE, plain, probability } from '../../format/numbers'
import { sentence, words } from '../../format/spans'
import { Place } from '../../ui/bars'
import { Spans } from '../../ui/Spans'
import type { RunData, UncertainParameter } from '../data/data'
import { tables } from '../../ui/styles'
import styles from './findings.module.css'

/** Whether findings have a likelihood in numbers. */
export const isLikely = (findings: readonly FindingDetail[]): boolean =>
  findings.some(({ likelihood }) => likelihood !== null && likelihood.density !== null)

/** Whether one point is more likely than another; in a box all are equally likely. It needs no number: the densities of
 * correlated parameters that are not normal are compared, but the highest is not known. */
const distinguishes = (findings: readonly FindingDetail[]): boolean =>
  findings.some(({ likelihood }) => likelihood !== null && likelihood.parameters > 0)

/** The distance in standard deviations, and how many draws are no more likely. */
export function LikelyCell({ likelihood }: { likelihood: Likelihood | null }) {
  if (likelihood?.tail == null) return <td className="num mut" title={likelihood?.text}>{NONE}</td>
  return (
    <td className="num" title={likelihood.text}>
      <span className={tables.rn}>
        {likelihood.distance === null ? '∞' : plain(likelihood.distance, 3)}
        <small>{probability(likelihood.tail, 2)} of draws</small>
      </span>
    </td>
  )
}

interface RowProps {
  data: RunData
  decimals: number
  /** Columns between margin and parameters. */
  between: number
}

/** The most likely violation, where findings violate and likelihood distinguishes them. */
export function MostLikelyRow(props: RowProps) {
  const { run, findings } = props.data
  const there = distinguishes(findings) && findings.some(({ margin }) => margin <= 0)
  const { data: most, isError } = useQuery({ ...mostLikelyQuery(run.id), enabled: there })
  if (there && isError && !most) return <NotLoaded />
  return there && most ? <LikelyViolation {...props} most={most} /> : null
}

const NotLoaded = () => (
  <tr>
    <td colSpan={99}>The most likely violation could not be loaded.</td>
  </tr>
)

export function LikelyViolation({ data, decimals, between, most }: RowProps & { most: MostLikely }) {
  const { case: found } = most
  if (!found) return null
  return (
    <tr data-finding="most likely">
      <td className="b nw" title={most.text}>Most likely violation</td>
      {hasScenario(data.campaign) && <td />}
      <td className="num b">{fixed(found.cost, decimals)}</td>
      <td className="num b bad-t">{margin(found.margin, decimals)}</td>
      {isLikely(data.findings) && <LikelyCell likelihood={found.likelihood} />}
      {between > 0 && <td colSpan={between} />}
      <Places of={{ ...found, at_bounds: {} }} parameters={data.parameters} />
      <td colSpan={3} className="sec small">
        <Spans spans={sentence(most.statement)} />
      </td>
    </tr>
  )
}

/** Where a case is within the bounds of each parameter. */
export const Places = ({ of, parameters }: { of: Pick<FindingDetail, 'parameters' | 'at_bounds'>; parameters: readonly UncertainParameter[] }) =>
  parameters.map((p) => (
    <td key={p.path} className={styles.place}>
      <Place low={p.low} high={p.high} nominal={p.nominal} value={of.parameters[p.path] ?? null} bound={p.path in of.at_bounds} />
    </td>
  ))

/** How likely the chosen finding is, as a sentence. */
export function LikelySentence({ data: { finding } }: { data: Pick<RunData, 'finding'> }) {
  if (!finding?.likelihood) return null
  const { likelihood, label } = finding
  const named = likelihood.density !== null
  return (
    <div>
      {named && <span className="sec">Likelihood of {label} under the stated distributions: </span>}
      <Spans spans={named ? [...likelihood.statement, words('.')] : sentence(likelihood.statement)} />
    </div>
  )
}
