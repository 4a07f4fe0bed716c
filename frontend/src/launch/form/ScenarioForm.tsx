// The scenario: components, obstacles, disturbances, horizon.
import { upperFirst } from '@mantine/hooks'
import { type List, LISTS, listAt } from '../../api/campaign'
import { Card } from '../../ui/Card'
import { criterionFor } from '../campaign/extents'
import { Adder } from '../fields/Field'
import { PartCard } from '../fields/PartCard'
import { ROLE_OF, type Section, sectionsOf } from '../campaign/parameters'
import { FieldErrors, idOf } from '../fields/problems'
import type { FormProps } from '../fields/props'
import { Realisations } from './Realisations'
import { SettingFields } from './SettingsForm'
import { SIMULATION } from '../campaign/settings'
import { layout } from '../../ui/styles'
import styles from './form.module.css'

const NONE: Record<List, string> = {
  obstacles: 'There is no obstacle yet.',
  environment: 'Still air, level ground without resistance.',
  faults: 'Sensing, timing and actuation are ideal.',
}

export function ScenarioForm(form: FormProps) {
  const sections = sectionsOf(form.campaign, form.catalogue).filter((section) => section.at[0] === 'scenario')
  return (
    <section aria-label="Scenario" id={idOf('scenario')} tabIndex={-1} className={layout.stack}>
      <h2 className={layout.sect}>Scenario</h2>
      <FieldErrors field="scenario" />
      <Card>
        <div className={styles.fields}>
          <SettingFields {...form} settings={SIMULATION} />
        </div>
      </Card>
      <Parts sections={sections.filter((section) => section.at.length === 2)} {...form} />
      {LISTS.map((list) => {
        const own = sections.filter((section) => section.at[1] === list)
        return (
          <div key={list} className={styles.partlist} id={idOf(`scenario.${list}`)} tabIndex={-1}>
            <div className={layout.row}>
              <h3>{upperFirst(list)}</h3>
              <AddPart list={list} {...form} />
              {own.length === 0 && <span className="small mut">{NONE[list]}</span>}
            </div>
            <FieldErrors field={`scenario.${list}`} />
            <Parts sections={own} list={list} {...form} />
          </div>
        )
      })}
      <Realisations {...form} />
    </section>
  )
}

interface PartsProps extends FormProps {
  sections: Section[]
  /** The list that they are in, from which each can be removed. */
  list?: List | 'objectives'
}

/** The cards of several parts. */
export function Parts({ sections, list, ...form }: PartsProps) {
  if (sections.length === 0) return null
  return (
    <div className={styles.parts}>
      {sections.map((section) => (
        <PartCard key={section.at.join('.')} section={section} {...form} onRemove={list && (() => form.remove(list, Number(section.at.at(-1))))} />
      ))}
    </div>
  )
}

/** A new part of a list: a copy of the last one if of the same component, else the component's defaults. */
export function AddPart({ list, campaign, catalogue, set }: FormProps & { list: List | 'objectives' }) {
  const parts = (list === 'objectives' ? campaign.objectives : campaign.scenario[list]) ?? []
  const role = ROLE_OF[list]
  const vehicle = catalogue.components.find((c) => c.role === 'vehicle' && c.name === campaign.scenario.vehicle.component)
  const fits = (dimension: number | null) => !dimension || !vehicle?.dimension || dimension === vehicle.dimension
  const found = catalogue.components.filter((c) => c.role === role && fits(c.dimension))
  const add = (name: string) => {
    const last = parts.at(-1)
    const copied = list === 'obstacles' && last?.component === name ? structuredClone(last) : null
    const next = [...parts, copied ?? { component: name, parameters: {} }]
    set(listAt(list), next)
    if (list !== 'obstacles') return
    const criterion = criterionFor(campaign, next, catalogue)
    if (criterion !== campaign.criterion) set(['criterion'], criterion)
  }
  return (
    <Adder
      key={parts.length}
      what={role}
      wide={280}
      position="bottom-start"
      data={found.map((c) => ({ value: c.name, label: c.title }))}
      onChange={add}
    />
  )
}
