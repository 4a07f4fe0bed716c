// The equations, sources and parameters of all components, from the catalogue: the texts are their docstrings.
import { useQuery } from '@tanstack/react-query'
import { catalogueQuery } from '../api/queries'
import { Skipped } from '../page/Skipped'
import { useTitle } from '../page/useTitle'
import type { ComponentEntry, SimulatorEntry } from '../client'
import { ComponentText } from './ComponentText'
import { HelpFrame, Unread } from './HelpFrame'
import { idOfComponent } from './links'
import { SimulatorText } from './SimulatorText'
import { Card } from '../ui/Card'
import layout from '../ui/layout.module.css'

const ROLES: readonly [ComponentEntry['role'], string][] = [
  ['vehicle', 'Vehicles'],
  ['controller', 'Controllers'],
  ['avoider', 'Avoiders'],
  ['obstacle', 'Obstacles'],
  ['environment', 'Environment'],
  ['fault', 'Faults'],
  ['criterion', 'Criteria'],
]

export function ComponentsPage() {
  useTitle('Components')
  const query = useQuery(catalogueQuery)
  const { components = [], simulators = [], unusable, version } = query.data ?? {}
  const roles = ROLES.flatMap(([role, title]) => {
    const found = components.filter((component) => component.role === role)
    return found.length > 0 ? [{ role, title, found }] : []
  })
  return (
    <HelpFrame
      title="Components"
      lede={`The components of scenarios in this installation${version ? ` (Clearance ${version})` : ''}. Each component is one file; the text here is its docstring.`}
      contents={[
        ...roles.map(({ title, found }) => ({
          title,
          entries: found.map((component) => ({
            id: idOfComponent(component.role, component.name),
            name: distinctTitle(component, found),
          })),
        })),
        ...(simulators.length > 0
          ? [{ title: 'Simulators', entries: simulators.map(({ name, title }) => ({ id: idOfComponent('simulator', name), name: title })) }]
          : []),
      ]}
    >
      {!query.data && <Unread what="the components" query={query} />}
      <Skipped unusable={unusable} />
      {roles.map(({ role, title, found }) => (
        <section key={role} className={layout.stack}>
          <h2 className={layout.sect}>{title}</h2>
          {found.map((component) => (
            <Component key={component.name} component={component} />
          ))}
        </section>
      ))}
      {simulators.length > 0 && (
        <section className={layout.stack}>
          <h2 className={layout.sect}>Simulators</h2>
          {simulators.map((simulator) => (
            <Simulator key={simulator.name} simulator={simulator} />
          ))}
        </section>
      )}
    </HelpFrame>
  )
}

/** Some components have two variants, planar and spatial. */
function distinctTitle({ title, dimension }: ComponentEntry, among: readonly ComponentEntry[]): string {
  const twice = among.filter((component) => component.title === title).length > 1
  return twice && dimension ? `${title}, ${dimension === 2 ? 'in the plane' : 'in space'}` : title
}

function Component({ component }: { component: ComponentEntry }) {
  const { role, name, title } = component
  return (
    <Card inner id={idOfComponent(role, name)} title={title} note={<span className="mono">{name}</span>} right={<span className="small mut">{facts(component)}</span>}>
      <div className={layout.stack}>
        <ComponentText component={component} />
      </div>
    </Card>
  )
}

function Simulator({ simulator }: { simulator: SimulatorEntry }) {
  const { name, title } = simulator
  return (
    <Card inner id={idOfComponent('simulator', name)} title={title} note={<span className="mono">{name}</span>}>
      <div className={layout.stack}>
        <SimulatorText simulator={simulator} />
      </div>
    </Card>
  )
}

function facts({ dimension, frame, role, demand, demands, fits, unit, quantity, path }: ComponentEntry): string {
  const axes = frame === 'ned' ? 'x north, y east, z down' : 'z up'
  return [
    dimension === 2 ? 'in the plane' : dimension === 3 ? 'in space' : null,
    role === 'vehicle' && dimension === 3 ? axes : null,
    demand ? `asks for a ${demand}` : null,
    demands.length ? `follows ${demands.join(' or ')}` : null,
    fits.length ? `for ${fits.join(', ').replaceAll('_', ' ')}` : null,
    path ? `in ${path}` : null,
    quantity ? `${quantity}${unit ? ` [${unit}]` : ''}` : null,
  ]
    .filter(Boolean)
    .join(' · ')
}
