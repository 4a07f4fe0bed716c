// One part of a campaign: its component, and its parameters with unit, limits and text from the catalogue.
import { clsx } from 'clsx'
import { type Campaign, place, type Raw } from '../../api/campaign'
import { plain } from '../../format/numbers'
import { unitText } from '../../format/units'
import { About } from '../../help/Docstring'
import { HelpLink, idOfComponent } from '../../help/links'
import { TextButton } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { Sign } from '../../ui/Sign'
import { Choice, RemoveButton } from './Field'
import { NumberCell } from './NumberCell'
import { numberOf, type Parameter, type Section } from '../campaign/parameters'
import { FieldErrors, idOf } from './problems'
import type { FormProps, SetValue } from './props'
import { layout } from '../../ui/styles'
import styles from './fields.module.css'

/** Up to this number of default parameters is not collapsed. */
const FEW = 4

interface PartCardProps extends Pick<FormProps, 'campaign' | 'catalogue' | 'set'> {
  section: Section
  onRemove?: () => void
}

export function PartCard({ onRemove, ...props }: PartCardProps) {
  const { title, component } = props.section
  const remove = onRemove && <RemoveButton label={`Remove ${title}`} onClick={onRemove} />
  return (
    <Card title={title} note={component?.dimension ? `${component.dimension}D` : undefined} right={remove}>
      <PartBody {...props} />
    </Card>
  )
}

/** The content without a card. */
export function PartBody({ section, campaign, catalogue, set }: Omit<PartCardProps, 'onRemove'>) {
  const { role, title, at, part, component } = section
  const field = at.join('.')
  const choices = catalogue.components.filter((c) => c.role === role).map((c) => ({ value: c.name, label: c.title }))
  const known = choices.some((choice) => choice.value === part.component)
  const vehicle = campaign.scenario.vehicle.component
  const inputs = catalogue.components.find((c) => c.role === 'vehicle' && c.name === vehicle)?.inputs ?? []
  const choose = (name: string) => {
    if (name === part.component) return
    const next = catalogue.components.find((c) => c.role === role && c.name === name)
    set([...at, 'component'], name)
    set([...at, 'parameters'], {})
    if (at[0] === 'criterion') set(['criterion', 'from_centre'], undefined)
    if (role === 'fault' && next?.path !== 'actuator') set([...at, 'on'], undefined)
  }
  return (
    <div id={idOf(field)} tabIndex={-1} style={{ display: 'grid', gap: 10 }}>
      <Choice
        field={`${field}.component`}
        aria-label={`${title}, component`}
        data={known ? choices : [...choices, { value: part.component, label: `${part.component} (unknown)` }]}
        value={part.component}
        onChange={choose}
      />
      {component?.quantity && (
        <p className="small mut">
          <Sign text={component.quantity} />
          {component.unit && `, ${unitText(component.unit)}`}: worse when {component.worse || 'low'}
        </p>
      )}
      <FieldErrors field={field} />
      <FieldErrors field={`${field}.component`} />
      {component?.path === 'actuator' && (
        <Choice field={`${field}.on`} label="On input" data={inputs} value={part.on ?? null} onChange={(on) => set([...at, 'on'], on)} />
      )}
      <FieldErrors field={`${field}.on`} />
      <Parameters section={section} campaign={campaign} set={set} />
      <Strays strays={section.strays} set={set} />
      {component && (
        <About summary="Equations and source" text={component.text}>
          <HelpLink to="/help/components" at={idOfComponent(component.role, component.name)}>In the help</HelpLink>
        </About>
      )}
    </div>
  )
}

/** Given, required and uncertain parameters; many parameters at their defaults are collapsed. */
function Parameters({ section, campaign, set }: { section: Section; campaign: Campaign; set: SetValue }) {
  const { title, part, parameters } = section
  const own = (parameter: Parameter) => parameter.group !== title || parameter.entry.name in (part.parameters ?? {})
  const isStated = (p: Parameter) => own(p) || p.entry.default === null || p.path in campaign.uncertain
  const rest = parameters.filter((parameter) => !isStated(parameter))
  const folded = rest.length > FEW ? rest : []
  const shown = parameters.filter((parameter) => !folded.includes(parameter))
  const groups = [...new Set(shown.map((parameter) => parameter.group))]
  const rows = (list: Parameter[]) => <ParameterGrid parameters={list} set={set} />
  return (
    <>
      {groups.map((group) => (
        <div key={group}>
          {group !== title && <h3 style={{ marginBottom: 4 }}>{group}</h3>}
          {rows(shown.filter((parameter) => parameter.group === group))}
        </div>
      ))}
      {folded.length > 0 && (
        <details>
          <summary>
            {folded.length} {shown.length > 0 ? 'more ' : ''}parameters at their defaults
          </summary>
          <div style={{ marginTop: 8 }}>{rows(folded)}</div>
        </details>
      )}
    </>
  )
}

export function ParameterGrid({ parameters, set }: { parameters: Parameter[]; set: SetValue }) {
  return (
    <div className={styles.pgrid}>
      {parameters.map((parameter) => (
        <ParameterField key={parameter.path} parameter={parameter} set={set} />
      ))}
    </div>
  )
}

function ParameterField({ parameter, set }: { parameter: Parameter; set: SetValue }) {
  const { entry, path, field } = parameter
  const unit = unitText(entry.unit)
  const change = (value: Raw | null) => set(place(path), value ?? undefined)
  return (
    <>
      <span className={styles.t}>
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

/** Values left from another component: unused, can only be removed. */
function Strays({ strays, set }: { strays: Section['strays']; set: SetValue }) {
  return strays.map(({ at, name, value }) => {
    const field = at.join('.')
    return (
      <div key={field} id={idOf(field)} tabIndex={-1}>
        <span className={clsx(layout.row, 'small')}>
          <span className="mono">{name}</span> {typeof value === 'number' ? plain(value) : value}
          <TextButton aria-label={`Remove ${field}`} onClick={() => set(at, undefined)}>Remove</TextButton>
        </span>
        <FieldErrors field={field} />
      </div>
    )
  })
}
