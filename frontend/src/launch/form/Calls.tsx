// How often a simulator is called for each evaluation, and how often a call that failed is tried again.
import { DEFAULTS } from '../../api/rules'
import type { Campaign, Raw } from '../../api/campaign'
import { Choice, NumberField } from '../fields/Field'
import { Fold } from '../fields/Fold'
import type { FormProps } from '../fields/props'
import styles from './form.module.css'

const REPEATS = 'simulator.repeats'
const RETRIES = 'simulator.retries'
/** Of a new quantile. */
const LOW = 0.1

/** A short summary: one call, or 5 calls of which the worst counts; retries. */
export function callsOf(campaign: Campaign): string {
  const { repeats, retries } = campaign.simulator ?? {}
  const calls = repeats
    ? `${repeats.count ?? DEFAULTS.count} calls for every evaluation, ${HOW[repeats.combine ?? 'worst'] ?? repeats.combine ?? ''}`
    : 'one call for every evaluation'
  return `${calls}${retries ? `; a failed call is tried again ${retries === 1 ? 'once' : `up to ${retries} times`}` : ''}`
}

const HOW: Record<string, string> = { worst: 'the worst counts', mean: 'their average counts', quantile: 'a quantile counts' }

export function Calls({ campaign, set }: FormProps) {
  const { repeats, retries } = campaign.simulator ?? {}
  const calls = (value: Raw | null) => {
    if (value === null) set(['simulator', 'repeats'], undefined)
    else set(['simulator', 'repeats'], { ...repeats, count: value })
  }
  const combine = (how: string) => {
    const { quantile, ...rest } = repeats ?? {}
    set(['simulator', 'repeats'], { ...rest, combine: how, ...(how === 'quantile' && { quantile: quantile ?? LOW }) })
  }
  return (
    <Fold title="Calls" digest={callsOf(campaign)} fields={[REPEATS, RETRIES]}>
      <div className={styles.fields}>
        <NumberField
          field={`${REPEATS}.count`}
          within={REPEATS}
          title="Repeats"
          label="Calls of the simulator for every evaluation"
          text="Calls for every evaluation, for a simulator that does not repeat; empty: one"
          value={repeats ? (repeats.count ?? DEFAULTS.count) : null}
          onChange={calls}
          optional
          placeholder="1"
        />
        {repeats && (
          <Choice
            field={`${REPEATS}.combine`}
            label="Which counts"
            data={[
              { value: 'worst', label: 'The worst of them' },
              { value: 'mean', label: 'Their average (never cleared)' },
              { value: 'quantile', label: 'A quantile (never cleared)' },
            ]}
            value={repeats.combine ?? 'worst'}
            onChange={combine}
          />
        )}
        {repeats?.combine === 'quantile' && (
          <NumberField
            field={`${REPEATS}.quantile`}
            title="Quantile"
            label="Quantile of the calls"
            value={repeats.quantile}
            onChange={(value) => set(['simulator', 'repeats', 'quantile'], value)}
          />
        )}
        <NumberField
          field={RETRIES}
          title="Retries"
          label="Retries of a failed call"
          text={<>An evaluation that needed a retry bars &quot;cleared&quot;</>}
          value={retries}
          onChange={(value) => set(['simulator', 'retries'], value ?? undefined)}
          optional
          placeholder="0"
        />
      </div>
    </Fold>
  )
}
