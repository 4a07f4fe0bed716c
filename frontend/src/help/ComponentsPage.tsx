// The equations, sources and parameters of all components, from the catalogue: the texts are their docstrings.
import { useQuery } from '@tanstack/react-query'
import { Fragment } from 'react'
import { catalogueQuery } from '../api/queries'
import { Skipped } from '../page/Skipped'
import { useTitle } from '../page/useTitle'
import type { ComponentEntry, SimulatorEntry } from '../client'
import { ComponentText } from './ComponentText'
import { HelpFrame, Unread } from './HelpFrame'
import { idOfComponent } from './links'
import { SimulatorText } from './SimulatorText'
import { Card } from '../ui/Card'
import { layout } from '../ui/styles'

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
  const groups = [
    ...ROLES.map(([role, title]) => {
      const found = components.filter((component) => component.role === role)
      return { title, entries: found.map((one) => ({ id: idOfComponent(role, one.name), name: distinctTitle(one, found), card: <Component component={one} /> })) }
    }),
    { title: 'Simulators', entries: simulators.map((one) => ({ id: idOfComponent('simulator', one.name), name: one.title, card: <Simulator simulator={one} /> })) },
  ].filter(({ entries }) => entries.length > 0)
  return (
    <HelpFrame
      title="Components"
      lede={`The components of scenarios in this installation${version ? ` (Clearance ${version})` : ''}. Each component is one file; the text here is its docstring.`}
      contents={groups}
    >
      {!query.data && <Unread what="the components" query={query} />}
      <Skipped unusable={unusable} />
      {groups.map(({ title, entries }) => (
        <section key={title} className={layout.stack}>
          <h2 className={layout.sect}>{title}</h2>
          {entries.map(({ id, card }) => (
            <Fragment key={id}>{card}</Fragment>
          ))}
        </section>
      ))}
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
