// Instead of a scenario: the simulator, its parameters, and the deciding result.
import { About } from '../../help/Docstring'
import { Card } from '../../ui/Card'
import { Sign } from '../../ui/Sign'
import { unitText } from '../../format/units'
import { StatedRequirements } from './CriterionForm'
import { Calls } from './Calls'
import { simulatorOf } from '../campaign/parameters'
import { Choice } from '../fields/Field'
import { ParameterGrid } from '../fields/PartCard'
import { FieldErrors, idOf } from '../fields/problems'
import type { FormProps } from '../fields/props'
import { layout } from '../../ui/styles'

export function SimulatorForm(form: FormProps) {
  const { campaign, catalogue, parameters, set } = form
  const entry = simulatorOf(campaign, catalogue)
  const name = campaign.simulator?.name ?? ''
  const choose = (next: string) => {
    if (next === name) return
    set(['simulator', 'name'], next)
    set(['simulator', 'parameters'], {})
  }
  return (
    <section aria-label="Simulator" id={idOf('simulator')} tabIndex={-1} className={layout.stack}>
      <h2 className={layout.sect}>Simulator</h2>
      <Card title={entry?.title ?? name}>
        <div style={{ display: 'grid', gap: 10 }}>
          <Choice
            field="simulator.name"
            aria-label="Simulator"
            data={choices(name, entry, (catalogue.simulators ?? []).map((s) => ({ value: s.name, label: s.title })))}
            value={name}
            onChange={choose}
          />
          <FieldErrors field="simulator" />
          <FieldErrors field="simulator.name" />
          <ParameterGrid parameters={parameters} set={set} />
          <Calls {...form} />
          {entry && <About summary="Description" text={entry.text} />}
        </div>
      </Card>
    </section>
  )
}

/** The deciding result; a simulator has no further criteria. */
export function ResultForm({ campaign, catalogue, set }: FormProps) {
  const results = (simulatorOf(campaign, catalogue)?.results ?? []).filter((result) => result.worse === 'low')
  const name = campaign.criterion.result ?? ''
  const decides = results.find((result) => result.name === name)
  return (
    <Card title="Criterion" note="The case is clear while this result stays above the threshold." id="section-criterion">
      <div style={{ display: 'grid', gap: 10, maxWidth: 480 }}>
        <Choice
          field="criterion.result"
          aria-label="Criterion, result"
          data={choices(name, decides, results.map((result) => ({ value: result.name, label: result.title })))}
          value={name}
          onChange={(next) => set(['criterion', 'result'], next)}
        />
        {decides && (
          <p className="small mut">
            <Sign text={decides.quantity} />
            {decides.unit && `, ${unitText(decides.unit)}`}: worse when low
          </p>
        )}
        <FieldErrors field="criterion.result" />
        <StatedRequirements campaign={campaign} />
      </div>
    </Card>
  )
}

const choices = (name: string, known: object | undefined, all: { value: string; label: string }[]) =>
  known ? all : [...all, { value: name, label: `${name} (unknown)` }]
