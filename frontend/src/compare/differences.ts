// Differences between campaigns: every setting by its path, including the components' default values.
import { asCampaign } from '../api/campaign'
import type { Catalogue, RunDetail } from '../client'
import { boundsOf, numberOf, parametersOf } from '../launch/campaign/parameters'

export type Setting = string | number | boolean | null

export interface Row {
  path: string
  group: string
  /** The description, for a parameter of a component. */
  text: string
  unit: string
  /** One value per run; undefined if the run has no such setting. */
  values: (Setting | undefined)[]
  differs: boolean
}

/** Descriptive texts, which do not affect the evaluation. */
const WORDS = ['name', 'summary', 'notes', 'tags', 'published', 'version']
/** The first words of paths, by group. */
const GROUPS: Readonly<Record<string, readonly string[]>> = {
  Scenario: ['vehicle', 'controller', 'avoider', 'scenario', 'start', 'goal', 'obstacles', 'environment', 'faults'],
  Simulator: ['simulator'],
  'Uncertain parameters': ['uncertain', 'correlations'],
  Criterion: ['criterion', 'objectives'],
  'Methods and stages': ['stages'],
}
const groupOf = (path: string): string =>
  Object.keys(GROUPS).find((group) => GROUPS[group]?.includes(path.split('.')[0] ?? '')) ?? 'Verdict and seed'

interface Described {
  run: Pick<RunDetail, 'campaign'>
  /** The descriptions of its own components. */
  catalogue: Catalogue | undefined
}

interface Entry {
  value: Setting
  text?: string
  unit?: string
}

/** Every setting of every run, in the order of the first that has it. */
export function differences(runs: readonly Described[]): Row[] {
  const all = runs.map(({ run, catalogue }) => settingsOf(run, catalogue))
  const paths = [...new Set(all.flatMap((settings) => [...settings.keys()]))]
  // A stage that is absent in one run is represented by its settings in the other.
  const inner = paths.filter((path) => !paths.some((other) => other.startsWith(`${path}.`)))
  return inner.map((path) => {
    const entries = all.map((settings) => settings.get(path))
    const known = entries.find((entry) => entry !== undefined)
    const values = entries.map((entry) => entry?.value)
    return {
      path,
      group: groupOf(path),
      text: known?.text ?? '',
      unit: known?.unit ?? '',
      values,
      differs: values.some((value) => value !== values[0]),
    }
  })
}

/** A campaign's settings by path: parameters with defaults, bounds as numbers, the rest unchanged. */
export function settingsOf(run: Pick<RunDetail, 'campaign'>, catalogue: Catalogue | undefined): Map<string, Entry> {
  const campaign = asCampaign(run.campaign)
  const found = new Map<string, Entry>()
  const listed = catalogue ? parametersOf(campaign, catalogue) : []
  const known = new Map(listed.map((parameter) => [parameter.path, parameter]))
  for (const { path, entry, nominal } of listed)
    found.set(path, { value: numberOf(nominal), text: entry.text, unit: entry.unit })
  for (const [path, uncertain] of Object.entries(campaign.uncertain)) {
    const parameter = known.get(path)
    const [low, high] = boundsOf(uncertain, parameter?.nominal ?? null).map(numberOf)
    const about = { text: parameter?.entry.text, unit: parameter?.entry.unit ?? uncertain.unit ?? '' }
    found.set(`uncertain.${path}.low`, { value: low ?? null, ...about })
    found.set(`uncertain.${path}.high`, { value: high ?? null, ...about })
    flatten(uncertain.distribution ?? { kind: 'uniform' }, `uncertain.${path}.distribution`, found)
  }
  flatten(rest(run.campaign, listed.length > 0), '', found)
  return found
}

/** The document without texts, bounds and, if the catalogue has them, parameters. */
function rest(campaign: Record<string, unknown>, known: boolean): Record<string, unknown> {
  const kept = Object.fromEntries(
    Object.entries(campaign).filter(([key]) => key !== 'uncertain' && !WORDS.includes(key)),
  )
  if (!known) return kept
  return withoutParameters(kept) as Record<string, unknown>
}

function withoutParameters(value: unknown, key = ''): unknown {
  if (Array.isArray(value)) return value.map((inner) => withoutParameters(inner, key))
  if (value === null || typeof value !== 'object') return value
  const part = 'component' in value
  const dropped = key === 'scenario' ? ['start', 'goal'] : part && key !== 'objectives' ? ['parameters'] : []
  const pairs = Object.entries(value).filter(([name]) => !dropped.includes(name))
  return Object.fromEntries(pairs.map(([name, inner]) => [name, withoutParameters(inner, name)]))
}

function flatten(value: unknown, path: string, into: Map<string, Entry>): void {
  if (value !== null && typeof value === 'object') {
    const times = new Map<string, number>()
    for (const [key, inner] of Object.entries(value)) {
      const name = namedBy(inner) ?? key
      const time = (times.get(name) ?? 0) + 1
      times.set(name, time)
      const part = time > 1 ? `${name} ${time}` : name
      flatten(inner, path ? `${path}.${part}` : part, into)
    }
    return
  }
  if (value !== undefined) into.set(path, { value: value as Setting })
}

/** Searches are identified by method, not by index; a second one of a method is numbered. */
const namedBy = (value: unknown): string | null =>
  typeof value === 'object' && value !== null && 'method' in value ? String(value.method) : null
