// The deciding criterion, and further criteria of every evaluation.
import { clsx } from 'clsx'
import type { Campaign, List } from '../../api/campaign'
import type { Catalogue } from '../../client'
import { plain } from '../../format/numbers'
import { Card } from '../../ui/Card'
import { toSurfaces, withinOf } from '../campaign/extents'
import { Fold } from '../fields/Fold'
import { PartBody, PartCard, type SetValue } from '../fields/PartCard'
import { sectionsOf } from '../campaign/parameters'
import { FieldErrors, idOf } from '../fields/problems'
import { AddPart } from './ScenarioForm'
import buttons from '../../ui/buttons.module.css'
import layout from '../../ui/layout.module.css'
import styles from './form.module.css'

interface CriterionFormProps {
  campaign: Campaign
  catalogue: Catalogue
  set: SetValue
  remove: (list: List | 'objectives', index: number) => void
}

export function CriterionForm({ campaign, catalogue, set, remove }: CriterionFormProps) {
  const sections = sectionsOf(campaign, catalogue)
  const decides = sections.find((section) => section.at[0] === 'criterion')
  const further = sections.filter((section) => section.at[0] === 'objectives')
  const shared = { campaign, catalogue, set }
  const titles = further.map((section) => section.component?.title ?? section.part.component).join(', ')
  const none = 'none; they do not affect the verdict, and NSGA-II searches for the Pareto front of all of them'
  return (
    <Card title="Criterion" note="An evaluation is clear while its value stays above the threshold." id="section-criterion">
      <div style={{ display: 'grid', gap: 10 }}>
        {decides && (
          <div style={{ maxWidth: 480 }}>
            <PartBody section={decides} {...shared} />
            <Centres {...shared} />
          </div>
        )}
        <StatedRequirements campaign={campaign} />
        <Fold title="Further criteria" digest={titles || none} fields={['objectives']}>
          <div id={idOf('objectives')} tabIndex={-1} className={layout.stack}>
            <FieldErrors field="objectives" />
            {further.length > 0 && (
              <div className={styles.parts}>
                {further.map((section) => (
                  <PartCard
                    key={section.at.join('.')}
                    section={section}
                    {...shared}
                    onRemove={() => remove('objectives', Number(section.at[1]))}
                  />
                ))}
              </div>
            )}
            <AddPart list="objectives" {...shared} />
          </div>
        </Fold>
      </div>
    </Card>
  )
}

/** What it is evidence for; written in the file. */
export function StatedRequirements({ campaign }: Pick<CriterionFormProps, 'campaign'>) {
  const stated = campaign.criterion.requirements
  return (
    <div id={idOf('criterion.requirements')} tabIndex={-1} className="small">
      {Array.isArray(stated) && stated.length > 0 && (
        <p>
          Evidence for: {stated.map((one) => (typeof one === 'string' ? one : (one?.id ?? '?'))).join(', ')}{' '}
          <span className="mut">(requirements are written in the YAML)</span>
        </p>
      )}
      <FieldErrors field="criterion.requirements" deep />
    </div>
  )
}

/** A hint for centre distances smaller than an obstacle: options, or the statement that it is intended. */
function Centres({ campaign, catalogue, set }: Omit<CriterionFormProps, 'remove'>) {
  const { criterion } = campaign
  const within = [...withinOf(campaign, catalogue).values()]
  if (criterion.from_centre)
    return (
      <p className="small">
        Stated: distances to the obstacles' centres are meant.{' '}
        <button type="button" className={clsx(buttons.btn, buttons.s)} onClick={() => set(['criterion', 'from_centre'], undefined)}>
          Withdraw
        </button>
      </p>
    )
  if (within.length === 0) return null
  return (
    <div className="small" role="note">
      <p>
        An obstacle extends {plain(Math.max(...within))} m from its centre, beyond the threshold: the vehicle could be
        inside it and the flight clear.
      </p>
      <button type="button" className={clsx(buttons.btn, buttons.s)} onClick={() => set(['criterion'], toSurfaces(criterion, catalogue))}>
        Measure to surfaces
      </button>{' '}
      <button type="button" className={clsx(buttons.btn, buttons.s)} onClick={() => set(['criterion', 'from_centre'], true)}>
        Centres are meant
      </button>
    </div>
  )
}
