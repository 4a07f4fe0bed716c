// Descriptions of the fields of a campaign's text, from the catalogue and the schema.
import { type Campaign, type Json, read } from '../../api/campaign'
import type { Catalogue, ComponentEntry, MethodEntry, ParameterEntry } from '../../client'
import { plain } from '../../format/numbers'
import { unitText } from '../../format/units'
import { type Parameter, parametersOf, type Role, ROLE_OF } from '../campaign/parameters'
import { type Setting, SIMULATION, STAGES, VERDICT } from '../campaign/settings'
import type { At } from '../text/tree'
import { scalar } from '../text/words'
import { boundsOf, optionsOf, type Schema } from '../../api/schema'
import { ruleAt, rulesOf } from '../text/schema'

export interface Known {
  catalogue: Catalogue
  /** The campaign as in the form: incomplete parts keep their parameters. */
  campaign: Campaign
  /** The campaign in the text, as far as it can be parsed. */
  document: Json
  schema: Schema | undefined
}

export interface Hint {
  title: string
  /** Unit, bounds, default. */
  detail: string
  text: string
}

export interface Choice extends Partial<Hint> {
  name: string
}

const ROLES: Record<string, Role> = {
  vehicle: 'vehicle',
  controller: 'controller',
  avoider: 'avoider',
  criterion: 'criterion',
  ...ROLE_OF,
}

const roleAt = (at: At): Role | undefined => ROLES[String(at[0] === 'scenario' ? at[1] : at[0])]

function ofParameter(entry: ParameterEntry): Hint {
  const parts = [
    unitText(entry.unit),
    boundsOf({ minimum: entry.low, maximum: entry.high }),
    entry.default === null ? 'must be given' : `default ${plain(entry.default)}`,
  ]
  return { title: entry.text, detail: parts.filter(Boolean).join(', '), text: '' }
}

/** The first paragraph of a component's text. */
const opening = (text: string): string => text.trim().split(/\n\s*\n/)[0]?.replace(/\s+/g, ' ') ?? ''

const ofComponent = (entry: ComponentEntry): Hint => ({
  title: entry.title,
  detail: entry.dimension ? `${entry.role}, ${entry.dimension}D` : entry.role,
  text: opening(entry.text),
})

const ofMethod = (entry: MethodEntry): Hint => ({ title: entry.title, detail: entry.source, text: `${entry.how}.` })

const SETTINGS = new Map<string, Setting>(
  [...SIMULATION, ...STAGES.flatMap((group) => group.settings), ...VERDICT].map((one) => [one.at.join('.'), one]),
)

function ofRule(at: At, rule: Schema): Hint {
  const setting = SETTINGS.get(at.join('.'))
  const rules = rulesOf(rule)
  const bounds = rules.map(boundsOf).find(Boolean) ?? ''
  const simple = ['number', 'string', 'boolean'].includes(typeof rule.default)
  const usual = simple && rule.default !== '' ? `default ${scalar(rule.default as Json)}` : ''
  const words = setting?.text ?? opening(rules.map((r) => r.description).find(Boolean) ?? '')
  const detail = [setting?.unit ?? '', bounds, usual].filter(Boolean).join(', ')
  return { title: setting?.label ?? String(at.at(-1)).replaceAll('_', ' '), detail, text: words }
}

function componentAt({ catalogue, document }: Known, at: At): ComponentEntry | undefined {
  const name = (read(document, at) as { component?: unknown } | undefined)?.component ?? (at[0] === 'criterion' ? 'separation' : '')
  return catalogue.components.find((c) => c.role === roleAt(at) && c.name === name)
}

const methodAt = ({ catalogue, document }: Known, at: At): MethodEntry | undefined => {
  const name = (read(document, at.slice(0, 3)) as { method?: unknown } | undefined)?.method
  return catalogue.methods.find((m) => m.name === name)
}

/** The parameters of a mapping by name; null if it has none. */
function entriesAt(known: Known, at: At): ParameterEntry[] | null {
  if (at.at(-1) === 'parameters') return componentAt(known, at.slice(0, -1))?.parameters ?? []
  if (at.join('.') === 'scenario.start') return componentAt(known, ['scenario', 'vehicle'])?.starts ?? []
  if (at.join('.') === 'scenario.goal') return componentAt(known, ['scenario', 'avoider'])?.goals ?? []
  return null
}

/** Fields of a campaign that a launch adds, and that its text may not have. */
const AT_LAUNCH = new Set(['baseline'])

/** Whether the keys of a mapping are paths of parameters. */
const holdsPaths = (at: At): boolean =>
  (at.length === 1 && at[0] === 'uncertain') || at.at(-2) === 'starts' || (at[0] === 'published' && at.at(-1) === 'at')

const isOptions = (at: At): boolean => at[1] === 'search' && at[3] === 'options' && at.length === 4

/** The description of a field; null if unknown. */
export function hintOf(known: Known, at: At): Hint | null {
  const [name, above] = [String(at.at(-1)), at.slice(0, -1)]
  const entry = entriesAt(known, above)?.find((one) => one.name === name)
  if (entry) return ofParameter(entry)
  const path = holdsPaths(above) ? name : at[0] === 'uncertain' ? String(at[1]) : null
  const parameter = path && parametersOf(known.campaign, known.catalogue).find((one) => one.path === path)
  if (parameter) return { ...ofParameter(parameter.entry), title: `${parameter.group}: ${parameter.entry.text}` }
  if (name === 'component') {
    const component = componentAt(known, above)
    if (component) return ofComponent(component)
  }
  const method = methodAt(known, at)
  if (name === 'method' && method) return ofMethod(method)
  const rule = isOptions(above) ? optionsOf(method)[name] : ruleAt(known.schema, at)
  return rule ? ofRule(at, rule) : null
}

/** The description of a name, if it adds information. */
function choiceOf(at: At, name: string, rule: Schema): Choice {
  const { title, ...rest } = ofRule([...at, name], rule)
  return title.toLowerCase() === name.replaceAll('_', ' ').toLowerCase() ? { name, ...rest } : { name, title, ...rest }
}

/** The possible keys of a mapping, without existing ones. */
export function keysAt(known: Known, at: At): Choice[] {
  const present = new Set(Object.keys((read(known.document, at) as object | null) ?? {}))
  return allKeys(known, at).filter(({ name }) => !present.has(name))
}

function allKeys(known: Known, at: At): Choice[] {
  const entries = entriesAt(known, at)
  if (entries) return entries.map((entry) => ({ name: entry.name, ...ofParameter(entry) }))
  if (holdsPaths(at)) return paths(known, at[0] !== 'uncertain')
  if (isOptions(at)) return Object.entries(optionsOf(methodAt(known, at))).map(([name, rule]) => choiceOf(at, name, rule))
  const rule = ruleAt(known.schema, at)
  const properties = rule ? rulesOf(rule).flatMap((one) => Object.entries(one.properties ?? {})) : []
  const offered = [...new Map(properties)].filter(([name]) => at.length > 0 || !AT_LAUNCH.has(name))
  return offered.map(([name, inner]) => choiceOf(at, name, inner))
}

/** Paths of parameters: those that are uncertain, or all. */
function paths({ campaign, catalogue }: Known, uncertain: boolean): Choice[] {
  return parametersOf(campaign, catalogue)
    .filter(({ path }) => !uncertain || path in campaign.uncertain)
    .map((parameter: Parameter) => ({
      name: parameter.path,
      ...ofParameter(parameter.entry),
      title: `${parameter.group}: ${parameter.entry.text}`,
    }))
}

/** The possible values. */
export function valuesAt(known: Known, at: At): Choice[] {
  const { catalogue, campaign } = known
  const [name, above] = [String(at.at(-1)), at.slice(0, -1)]
  if (name === 'component' && roleAt(at)) {
    const role = roleAt(at)
    return catalogue.components.filter((c) => c.role === role).map((c) => ({ name: c.name, ...ofComponent(c) }))
  }
  if (name === 'method') return catalogue.methods.map((m) => ({ name: m.name, ...ofMethod(m) }))
  if (name === 'on') return (componentAt(known, ['scenario', 'vehicle'])?.inputs ?? []).map((input) => ({ name: input }))
  if (above.at(-1) === 'between') return paths(known, true)
  if (name === 'unit' && at[0] === 'uncertain') {
    const found = parametersOf(campaign, catalogue).find(({ path }) => path === at[1])
    return found ? [{ name: found.entry.unit || '1', title: found.entry.text, detail: '', text: '' }] : []
  }
  const rule = isOptions(above) ? optionsOf(methodAt(known, at))[name] : ruleAt(known.schema, at)
  if (!rule) return []
  const rules = rulesOf(rule)
  const values = rules.flatMap((one) => one.enum ?? (one.const !== undefined ? [one.const] : one.type === 'boolean' ? [true, false] : []))
  return values.map((value) => ({ name: scalar(value) }))
}
