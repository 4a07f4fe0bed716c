// The empty list: what Clearance does, and what to do first.
import { IconFileText } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { asCampaign } from '../api/campaign'
import { catalogueQuery, libraryQuery } from '../api/queries'
import { PlanView } from '../launch/plan/PlanView'
import { ordered } from '../launch/library/shelf'
import { ButtonLink } from '../ui/Button'
import { cards, layout } from '../ui/styles'
import styles from './runs.module.css'

export function NoRuns() {
  const { data } = useQuery(libraryQuery)
  const { data: catalogue } = useQuery(catalogueQuery)
  const first = data && ordered(data)[0]
  return (
    <div className={cards.card}>
      <div className={layout.centre} style={{ paddingBottom: 36 }}>
        {first && (
          <figure>
            <div className={styles.emptypic}>
              <PlanView campaign={asCampaign(first.document)} catalogue={catalogue} flight={first.nominal} height={168} />
            </div>
            <figcaption className="micro mut">{asCampaign(first.document).name}, {first.nominal ? 'nominal case ' : ''}seen from above</figcaption>
          </figure>
        )}
        <h2 style={{ fontSize: 17, marginTop: 8 }}>No runs yet</h2>
        <p>
          A run searches the bounded uncertain parameters for the smallest separation, samples them independently, and
          simulates the worst case again before it reports a verdict.
        </p>
        <div className={layout.acts} style={{ marginTop: 8 }}>
          <ButtonLink main to="/launch">Choose a case study</ButtonLink>
          <ButtonLink icon={IconFileText} to="/launch" search={{ tab: 'yaml' }}>Paste or drop a campaign file</ButtonLink>
        </div>
      </div>
      <ol className={styles.firststeps}>
        <li>
          <h3>Choose a case</h3>
          <p className="small sec">Case studies ship with Clearance. Your own vehicle, controller or avoider is one Python file.</p>
        </li>
        <li>
          <h3>Bound the parameters</h3>
          <p className="small sec">Give each uncertain parameter a nominal value, limits and a distribution.</p>
        </li>
        <li>
          <h3>Read the verdict</h3>
          <p className="small sec">Cleared, violated or inconclusive, with the worst case, its trajectory and the effort of the search.</p>
        </li>
      </ol>
    </div>
  )
}
