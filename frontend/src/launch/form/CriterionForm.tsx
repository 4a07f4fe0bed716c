// The deciding criterion, and further criteria of every evaluation.
import { plain } from '../../format/numbers'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { toSurfaces, withinOf } from '../campaign/extents'
import { Fold } from '../fields/Fold'
import { PartBody } from '../fields/PartCard'
import { sectionsOf } from '../campaign/parameters'
import { FieldErrors, idOf } from '../fields/problems'
import type { FormProps } from '../fields/props'
import { AddPart, Parts } from './ScenarioForm'
import { layout } from '../../ui/styles'

export function CriterionForm(form: FormProps) {
  const { campaign, catalogue } = form
  const sections = sectionsOf(campaign, catalogue)
  const decides = sections.find((section) => section.at[0] === 'criterion')
  const further = sections.filter((section) => section.at[0] === 'objectives')
  const titles = further.map((section) => section.component?.title ?? section.part.component).join(', ')
  const none = 'none; they do not affect the verdict, and NSGA-II searches for the Pareto front of all of them'
  return (
    <Card title="Criterion" note="An evaluation is clear while its value stays above the threshold." id="section-criterion">
      <div style={{ display: 'grid', gap: 10 }}>
        {decides && (
          <div style={{ maxWidth: 480 }}>
            <PartBody section={decides} {...form} />
            <Centres {...form} />
          </div>
        )}
        <StatedRequirements campaign={campaign} />
        <Fold title="Further criteria" digest={titles || none} fields={['objectives']}>
          <div id={idOf('objectives')} tabIndex={-1} className={layout.stack}>
            <FieldErrors field="objectives" />
            <Parts sections={further} list="objectives" {...form} />
            <AddPart list="objectives" {...form} />
          </div>
        </Fold>
      </div>
    </Card>
  )
}

/** What it is evidence for; written in the file. */
export function StatedRequirements({ campaign }: Pick<FormProps, 'campaign'>) {
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
function Centres({ campaign, catalogue, set }: FormProps) {
  const { criterion } = campaign
  const within = [...withinOf(campaign, catalogue).values()]
  if (criterion.from_centre)
    return (
      <p className="small">
        Stated: distances to the obstacles' centres are meant.{' '}
        <Button small onClick={() => set(['criterion', 'from_centre'], undefined)}>
          Withdraw
        </Button>
      </p>
    )
  if (within.length === 0) return null
  return (
    <div className="small" role="note">
      <p>
        An obstacle extends {plain(Math.max(...within))} m from its centre, beyond the threshold: the vehicle could be
        inside it and the flight clear.
      </p>
      <Button small onClick={() => set(['criterion'], toSurfaces(criterion, catalogue))}>
        Measure to surfaces
      </Button>{' '}
      <Button small onClick={() => set(['criterion', 'from_centre'], true)}>
        Centres are meant
      </Button>
    </div>
  )
}
