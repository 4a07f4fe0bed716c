// The five key figures of a finished run: worst, margin, nominal, bound on P(violation), evaluations.
import { samplerOf } from '../../api/stages'
import { sourceOf, unknownOf, violatedOf, withoutValue } from '../../format/counts'
import { atMost, confidenceText, count, decimalsBeside, decimalsFor, duration, exact, fixed, goal, margin, NONE } from '../../format/numbers'
import { numberOf } from '../../launch/campaign/parameters'
import { Stat } from '../../ui/Card'
import { methodLook } from '../../ui/methods'
import { Sign } from '../../ui/Sign'
import { worstOf } from '../data/chosen'
import { drawn, finderOf, type RunData } from '../data/data'
import runStyles from '../run.module.css'
import { whereOf } from './where'
import { cards } from '../../ui/styles'

export function FiveFigures({ data }: { data: Pick<RunData, 'run' | 'campaign' | 'findings' | 'stages'> }) {
  const { run, campaign } = data
  const statistics = run.summary?.statistics ?? null
  const source = sourceOf(run.bound_source)
  const decimals = decimalsBeside([run.worst_cost, run.nominal_cost], run.threshold)
  const share = run.margin !== null && run.threshold ? run.margin / Math.abs(run.threshold) : null
  const lower = run.nominal_cost !== null && run.worst_cost !== null ? run.nominal_cost - run.worst_cost : null
  const worst = data.findings.find(({ label }) => label === worstOf(run))
  const method = worst ? finderOf(data, worst) : run.worst_method
  const [at] = run.stages
    .filter((stage) => method !== null && stage.method === method)
    .sort((a, b) => (a.best ?? Infinity) - (b.best ?? Infinity))
  const target = numberOf(campaign.target_probability)
  const compute = run.stages.reduce((sum, stage) => sum + stage.seconds, 0)
  const quantity = <Sign text={run.quantity || 'value'} />
  const [bound, percents] = atMost(statistics?.upper_bound).split('\u202f')
  return (
    <div className={cards.card} style={{ marginTop: 'var(--gap)' }}>
      <div className={runStyles.stats}>
        <Stat
          name={<>Worst {quantity}</>}
          value={fixed(run.worst_cost, decimals)}
          exact={run.worst_cost}
          unit={run.worst_cost === null ? undefined : run.unit}
          testId="worst"
          note={
            method
              ? `${methodLook(method).title}${whereOf(at, run.worst_cost)}`
              : !worst ? 'none found' : drawn(worst) ? samplerOf(data.stages) : 'found by no search'
          }
        />
        <Stat
          name="Margin to criterion"
          value={margin(run.margin, decimals)}
          exact={run.margin}
          unit={run.margin === null ? undefined : run.unit}
          bad={run.margin !== null && run.margin <= 0}
          testId="margin"
          note={
            <>
              {`${share === null ? '' : `${margin(share * 100, Math.abs(share) < 1 ? 1 : 0)} % of `}${exact(run.threshold)} ${run.unit}`}
              {unknownOf(run) && <span className="unk-t">; {unknownOf(run)}</span>}
            </>
          }
        />
        <Stat
          name={<>Nominal {quantity}</>}
          value={fixed(run.nominal_cost, decimals)}
          exact={run.nominal_cost}
          unit={run.nominal_cost === null ? undefined : run.unit}
          note={run.nominal_cost === null ? 'the nominal case has no value' : lower === null ? '' : `worst is ${fixed(lower, decimalsFor([lower], 3))} ${run.unit} lower`}
        />
        <Stat
          name={statistics ? `P(violation), ${confidenceText(statistics.confidence)} upper bound` : 'P(violation)'}
          value={bound ?? NONE}
          exact={statistics ? (percents ? 100 : 1) * statistics.upper_bound : null}
          unit={percents}
          note={
            statistics
              ? `${violatedOf(statistics)}${source && `; ${source}`}${target === null ? '' : `; target ${goal(target)}`}`
              : 'no independent sample'
          }
        />
        <Stat
          name="Evaluations"
          value={count(run.evaluations)}
          note={`${withoutValue(run)}, ${duration(compute)} compute`}
        />
      </div>
    </div>
  )
}
