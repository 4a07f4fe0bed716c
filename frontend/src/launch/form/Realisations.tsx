// The noise and gust realisations of every evaluation; only for scenarios with random components.
import { Card } from '../../ui/Card'
import { Choice, Labelled } from '../fields/Field'
import { Fold } from '../fields/Fold'
import { ListCell } from '../fields/NumberCell'
import type { FormProps } from '../fields/props'
import { sectionsOf } from '../campaign/parameters'
import styles from './form.module.css'

const FIELD = 'scenario.realisations'
/** The parameter that sets the realisation of a random component. */
const SEED = 'seed'

export function Realisations({ campaign, catalogue, set }: FormProps) {
  const { seeds = [0], combine = 'worst' } = campaign.scenario.realisations ?? {}
  const random = sectionsOf(campaign, catalogue)
    .filter(({ role }) => role === 'environment' || role === 'fault')
    .some(({ parameters }) => parameters.some(({ entry }) => entry.name === SEED))
  if (!random && seeds.length < 2) return null
  const digest = `${seeds.length} ${seeds.length === 1 ? 'simulation' : 'simulations'} for every evaluation`
  return (
    <Card>
      <Fold title="Noise realisations" digest={digest} fields={[FIELD]}>
        <div className={styles.fields}>
          <Labelled field={`${FIELD}.seeds`} label="Seeds" text="Whole numbers separated by commas; every evaluation simulates all of them" within={`${FIELD}.seeds`}>
            <ListCell
              field={`${FIELD}.seeds`}
              label="Seeds of the realisations"
              values={seeds}
              onChange={(values) => set(['scenario', 'realisations', 'seeds'], values)}
            />
          </Labelled>
          <Labelled field={`${FIELD}.combine`} label="Which counts">
            <Choice
              field={`${FIELD}.combine`}
              data={[
                { value: 'worst', label: 'The worst of them' },
                { value: 'mean', label: 'Their average' },
              ]}
              value={combine}
              onChange={(value) => set(['scenario', 'realisations', 'combine'], value)}
            />
          </Labelled>
        </div>
      </Fold>
    </Card>
  )
}
