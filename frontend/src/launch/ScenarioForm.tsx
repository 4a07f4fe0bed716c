// The scenario: which component plays each part, and its parameters with unit, limits and text from the catalogue.
import { Select } from '@mantine/core'
import { IconPlus, IconTrash } from '@tabler/icons-react'
import { type Campaign, place } from '../api/campaign'
import type { Catalogue } from '../client'
import { plain } from '../format/numbers'
import { unitText } from '../format/units'
import { Card } from '../ui/Card'
import { Sign } from '../ui/Sign'
import { NumberCell } from './NumberCell'
import { numberOf, type Parameter, type Section, sectionsOf } from './parameters'
import { FieldErrors, idOf } from './problems'

type Set = (at: readonly (string | number)[], value: unknown) => void

interface ScenarioFormProps {
  campaign: Campaign
  catalogue: Catalogue
  set: Set
}

export function ScenarioForm({ campaign, catalogue, set }: ScenarioFormProps) {
  const obstacles = campaign.scenario.obstacles ?? []
  const add = () => {
    const last = obstacles[obstacles.length - 1]
    const first = catalogue.components.find((c) => c.role === 'obstacle')
    const made = last ? structuredClone(last) : { component: first?.name ?? '', parameters: {} }
    set(['scenario', 'obstacles'], [...obstacles, made])
  }
  const remove = (at: number) =>
    set(
      ['scenario', 'obstacles'],
      obstacles.filter((_, i) => i !== at),
    )
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
            set={set}
            onRemove={section.role === 'obstacle' ? () => remove(Number(section.at[2])) : undefined}
          />
        ))}
        <button type="button" className="btn" style={{ justifySelf: 'start', alignSelf: 'start' }} onClick={add}>
          <IconPlus className="i s" aria-hidden />{' '}
          {obstacles.length > 0 ? 'Add a copy of the last obstacle' : 'Add obstacle'}
        </button>
      </div>
    </section>
  )
}

interface PartCardProps {
  section: Section
  catalogue: Catalogue
  set: Set
  onRemove?: () => void
}

function PartCard({ section, catalogue, set, onRemove }: PartCardProps) {
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
            <p className="about">{component.text}</p>
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
