// The equations, sources and parameters of all components, from the catalogue: the texts are their docstrings.
import { useQuery } from '@tanstack/react-query'
import { catalogueQuery } from '../api/queries'
import { Skipped } from '../page/Skipped'
import { useTitle } from '../page/useTitle'
import type { ComponentEntry } from '../client'
import { ComponentText } from './ComponentText'
import { Chapters, HelpFrame, Unread } from './HelpFrame'
import { idOfComponent } from './links'
import { SimulatorText } from './SimulatorText'

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
      const entries = found.map((one) => ({
        ...entryOf(role, one, distinctTitle(one, found)),
        right: <span className="small mut">{facts(one)}</span>,
        text: <ComponentText component={one} />,
      }))
      return { title, entries }
    }),
    { title: 'Simulators', entries: simulators.map((one) => ({ ...entryOf('simulator', one), text: <SimulatorText simulator={one} /> })) },
  ].filter(({ entries }) => entries.length > 0)
  return (
    <HelpFrame
      title="Components"
      lede={`The components of scenarios in this installation${version ? ` (Clearance ${version})` : ''}. Each component is one file; the text here is its docstring.`}
      contents={groups}
    >
      {!query.data && <Unread what="the components" query={query} />}
      <Skipped unusable={unusable} />
      <Chapters of={groups} />
    </HelpFrame>
  )
}

/** Some components have two variants, planar and spatial. */
function distinctTitle({ title, dimension }: ComponentEntry, among: readonly ComponentEntry[]): string {
  const twice = among.filter((component) => component.title === title).length > 1
  return twice && dimension ? `${title}, ${dimension === 2 ? 'in the plane' : 'in space'}` : title
}

const entryOf = (role: string, { name, title }: Pick<ComponentEntry, 'name' | 'title'>, listed = title) =>
  ({ id: idOfComponent(role, name), name: listed, title, note: <span className="mono">{name}</span> })

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
