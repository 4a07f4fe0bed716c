// The scenario: which component plays each part, and its parameters with unit, limits and text from the catalogue.
import { Select } from '@mantine/core'
import { IconPlus, IconTrash } from '@tabler/icons-react'
import { type Campaign, type List, LISTS, place } from '../api/campaign'
import type { Catalogue } from '../client'
import { plain } from '../format/numbers'
import { unitText } from '../format/units'
import { Docstring } from '../help/Docstring'
import { HelpLink, idOfComponent } from '../help/links'
import { Card } from '../ui/Card'
import { Sign } from '../ui/Sign'
import { NumberCell } from './NumberCell'
import { numberOf, type Parameter, ROLE_OF, type Section, sectionsOf } from './parameters'
import { FieldErrors, idOf } from './problems'

type Set = (at: readonly (string | number)[], value: unknown) => void

interface ScenarioFormProps {
  campaign: Campaign
  catalogue: Catalogue
  set: Set
}

export function ScenarioForm({ campaign, catalogue, set }: ScenarioFormProps) {
  const parts = (list: List) => campaign.scenario[list] ?? []
  const add = (list: List) => {
    const last = parts(list).at(-1)
    const first = catalogue.components.find((c) => c.role === ROLE_OF[list])
    const made = last ? structuredClone(last) : { component: first?.name ?? '', parameters: {} }
    set(['scenario', list], [...parts(list), made])
  }
  const remove = (list: List, at: number) =>
    set(
      ['scenario', list],
      parts(list).filter((_, i) => i !== at),
    )
  const vehicle = campaign.scenario.vehicle.component
  const inputs = catalogue.components.find((c) => c.role === 'vehicle' && c.name === vehicle)?.inputs ?? []
  const addable = LISTS.filter((list) => catalogue.components.some((c) => c.role === ROLE_OF[list]))
  return (
    <section aria-label="Scenario" id={idOf('scenario')} tabIndex={-1}>
      <h2 className="sect">Scenario</h2>
      <FieldErrors field="scenario" />
      <div className="parts">
        {sectionsOf(campaign, catalogue).map((section) => (
          <PartCard
            key={section.at.join('.')}
            section={section}
            catalogue={catalogue}
            inputs={inputs}
            set={set}
            onRemove={removal(section, remove)}
          />
        ))}
        <div className="row" style={{ alignSelf: 'start', flexWrap: 'wrap' }}>
          {addable.map((list) => (
            <button key={list} type="button" className="btn" onClick={() => add(list)}>
              <IconPlus className="i s" aria-hidden /> Add {ROLE_OF[list]}
            </button>
          ))}
        </div>
      </div>
    </section>
  )
}

/** How a part is taken out, where it is one of a list. */
function removal({ at }: Section, remove: (list: List, at: number) => void): (() => void) | undefined {
  const list = LISTS.find((name) => name === at[1])
  return list && (() => remove(list, Number(at[2])))
}

interface PartCardProps {
  section: Section
  catalogue: Catalogue
  /** Of the vehicle: what actuator faults are on. */
  inputs: string[]
  set: Set
  onRemove?: () => void
}

function PartCard({ section, catalogue, inputs, set, onRemove }: PartCardProps) {
  const { role, title, at, part, component, parameters } = section
  const field = at.join('.')
  const choices = catalogue.components.filter((c) => c.role === role).map((c) => ({ value: c.name, label: c.title }))
  const known = choices.some((choice) => choice.value === part.component)
  const groups = [...new Set(parameters.map((parameter) => parameter.group))]
  const choose = (name: string | null) => {
    if (!name || name === part.component) return
    set([...at, 'component'], name)
    set([...at, 'parameters'], {})
  }
  const remove = onRemove && (
    <button type="button" className="iconbtn" aria-label={`Remove ${title}`} title="Remove" onClick={onRemove}>
      <IconTrash className="i s" aria-hidden />
    </button>
  )
  return (
    <Card title={title} note={component?.dimension ? `${component.dimension}D` : undefined} right={remove}>
      <div id={idOf(field)} tabIndex={-1} style={{ display: 'grid', gap: 10 }}>
        <Select
          id={idOf(`${field}.component`)}
          aria-label={`${title}, component`}
          size="xs"
          data={known ? choices : [...choices, { value: part.component, label: `${part.component} (unknown)` }]}
          value={part.component}
          allowDeselect={false}
          onChange={choose}
        />
        <FieldErrors field={field} />
        <FieldErrors field={`${field}.component`} />
        {component?.path === 'actuator' && (
          <Select
            id={idOf(`${field}.on`)}
            label="On input"
            labelProps={{ className: 'lbl' }}
            size="xs"
            data={inputs}
            value={part.on ?? null}
            onChange={(on) => set([...at, 'on'], on ?? '')}
          />
        )}
        <FieldErrors field={`${field}.on`} />
        {groups.map((group) => (
          <div key={group}>
            {group !== title && <h3 style={{ marginBottom: 4 }}>{group}</h3>}
            <div className="pgrid">
              {parameters
                .filter((parameter) => parameter.group === group)
                .map((parameter) => (
                  <ParameterField key={parameter.path} parameter={parameter} set={set} />
                ))}
            </div>
          </div>
        ))}
        {component && (
          <details>
            <summary>Equations and source</summary>
            <div className="about">
              <Docstring text={component.text} />
              <HelpLink to="/help/components" at={idOfComponent(component.role, component.name)}>
                In the help
              </HelpLink>
            </div>
          </details>
        )}
      </div>
    </Card>
  )
}

function ParameterField({ parameter, set }: { parameter: Parameter; set: Set }) {
  const { entry, path, field } = parameter
  const unit = unitText(entry.unit)
  const change = (value: number | string | null) => set(place(path), value ?? undefined)
  return (
    <>
      <span className="t">
        <Sign text={entry.symbol} /> {entry.text}
        <small>
          {entry.low === -entry.high ? `±${plain(entry.high)}` : `${plain(entry.low)} to ${plain(entry.high)}`} {unit}
        </small>
      </span>
      <NumberCell
        field={field}
        label={`${parameter.group}, ${entry.text}`}
        value={numberOf(parameter.nominal) ?? parameter.nominal}
        optional={entry.default !== null}
        onChange={change}
      />
      <span className="sec nw">{unit}</span>
      <FieldErrors field={field} />
    </>
  )
}
