// Every parameter of a campaign by its path, with its entry in the catalogue, nominal value and bounds. The rules are
// those of the service's check, but tolerate incomplete input.
import { upperFirst } from '@mantine/hooks'
import { type Campaign, fieldOf, type List, LISTS, type Part, type Raw, type Uncertain } from '../../api/campaign'
import type { Catalogue, ComponentEntry, ParameterEntry, ResultEntry, SimulatorEntry } from '../../client'
import { parse } from '../../format/numbers'

export type Role = ComponentEntry['role']

export interface Parameter {
  path: string
  /** Its name in the service's problems. */
  field: string
  group: string
  entry: ParameterEntry
  nominal: Raw | null
}

export interface Section {
  role: Role
  title: string
  /** The location of the part in the document. */
  at: (string | number)[]
  part: Part
  component: ComponentEntry | undefined
  parameters: Parameter[]
  /** Values of unknown parameters, by location. */
  strays: { at: (string | number)[]; name: string; value: Raw }[]
}

export const ROLE_OF: Record<List | 'objectives', Role> = { obstacles: 'obstacle', environment: 'environment', faults: 'fault', objectives: 'criterion' }

/** The parts of a campaign, in the order of the form. */
export function sectionsOf(campaign: Campaign, catalogue: Catalogue): Section[] {
  if (campaign.simulator) return []
  const { scenario } = campaign
  const { vehicle, avoider, start = {}, goal } = scenario
  const find = (role: Role, part: Part) =>
    catalogue.components.find((c) => c.role === role && c.name === part.component)
  const section = (role: Role, prefix: string, at: (string | number)[], part: Part, title = upperFirst(role)): Section => {
    const component = find(role, part)
    const values = part.parameters ?? {}
    const entries = component?.parameters ?? []
    const strays = component ? strayed(entries, values, [...at, 'parameters']) : []
    return { role, title, at, part, component, parameters: listed(prefix, title, entries, values), strays }
  }
  const sections = [
    ...(['vehicle', 'controller', 'avoider'] as const).map((role) => section(role, role, ['scenario', role], scenario[role])),
    ...LISTS.flatMap((list) =>
      (scenario[list] ?? []).map((part, i) =>
        section(ROLE_OF[list], `${list}.${i}`, ['scenario', list, i], part, `${upperFirst(ROLE_OF[list])} ${i + 1}`),
      ),
    ),
    section('criterion', 'criterion', ['criterion'], campaign.criterion),
    ...(campaign.objectives ?? []).map((part, i) =>
      section('criterion', `objectives.${i}`, ['objectives', i], part, `Further criterion ${i + 1}`),
    ),
  ]
  const also = (at: number, name: 'start' | 'goal', entries: ParameterEntry[] | undefined, values: Record<string, Raw>) => {
    sections[at]?.parameters.push(...listed(name, upperFirst(name), entries ?? [], values))
    if (entries) sections[at]?.strays.push(...strayed(entries, values, ['scenario', name]))
  }
  also(0, 'start', find('vehicle', vehicle)?.starts, start)
  also(2, 'goal', find('avoider', avoider)?.goals, goal)
  return sections
}

const strayed = (entries: ParameterEntry[], values: Record<string, Raw>, at: (string | number)[]): Section['strays'] =>
  Object.entries(values)
    .filter(([name]) => !entries.some((entry) => entry.name === name))
    .map(([name, value]) => ({ at: [...at, name], name, value }))

function listed(prefix: string, group: string, entries: ParameterEntry[], values: Record<string, Raw>): Parameter[] {
  return entries.map((entry) => {
    const path = `${prefix}.${entry.name}`
    return { path, field: fieldOf(path), group, entry, nominal: values[entry.name] ?? entry.default }
  })
}

export const parametersOf = (campaign: Campaign, catalogue: Catalogue): Parameter[] =>
  campaign.simulator
    ? ofSimulator(campaign, catalogue)
    : sectionsOf(campaign, catalogue).flatMap((section) => section.parameters)

function ofSimulator(campaign: Campaign, catalogue: Catalogue): Parameter[] {
  const known = simulatorOf(campaign, catalogue)
  return listed('simulator', known?.title ?? '', known?.parameters ?? [], campaign.simulator?.parameters ?? {})
}

/** The simulator of a campaign; undefined if unknown or if there is a scenario. */
export const simulatorOf = (campaign: Campaign, catalogue: Catalogue): SimulatorEntry | undefined =>
  catalogue.simulators?.find((each) => each.name === campaign.simulator?.name)

/** The deciding criterion of the scenario, or result of the simulator. */
export const decidingOf = (campaign: Campaign, catalogue: Catalogue): ComponentEntry | ResultEntry | undefined =>
  campaign.simulator
    ? simulatorOf(campaign, catalogue)?.results.find((result) => result.name === campaign.criterion.result)
    : criterionOf(campaign, catalogue)

export const criterionOf = (campaign: Campaign, catalogue: Catalogue | undefined): ComponentEntry | undefined =>
  catalogue?.components.find((c) => c.role === 'criterion' && c.name === campaign.criterion.component)

/** Parses a raw value; null if it is not a number. */
export function numberOf(raw: Raw | null | undefined): number | null {
  if (raw === null || raw === undefined) return null
  return typeof raw === 'number' ? raw : parse(raw)
}

/** Low and high of an uncertain parameter; a percentage of the nominal value is converted. */
export function boundsOf(uncertain: Uncertain, nominal: Raw | null): [Raw | null, Raw | null] {
  const tolerance = uncertain.plus_minus
  if (tolerance === null || tolerance === undefined) return [uncertain.low ?? null, uncertain.high ?? null]
  const middle = numberOf(nominal)
  const share = /^\s*([0-9.eE+-]+)\s*%\s*$/.exec(String(tolerance))
  const amount = share ? Number(share[1]) / 100 : numberOf(tolerance)
  if (middle === null || amount === null || !Number.isFinite(amount)) return [null, null]
  const reach = share ? amount * Math.abs(middle) : amount
  // Avoids binary rounding: 0.05 + 20 % must give 0.06.
  const round = (value: number) => Number(value.toPrecision(12))
  return [round(middle - reach), round(middle + reach)]
}
