// Shows an incomplete or invalid text in the form, as far as its structure is that of a campaign.
import type { Campaign, Json } from '../../api/campaign'
import type { Schema } from '../../api/schema'
import { rulesOf } from './schema'
import { parsed, plain } from './tree'
import { isMapping } from './words'

type Rules = Record<string, Schema>

/** The approximate campaign of a text, with the schema's defaults; null if the form cannot show it. */
export function formOf(text: string, schema: unknown): Campaign | null {
  const tree = parsed(text)
  const typed = tree && plain(tree)
  if (!isMapping(typed)) return null
  const rule = schema as Schema
  const found = filled(typed, rule, rule.$defs ?? {})
  if (!isMapping(found) || !fits(found, rule, rule.$defs ?? {})) return null
  // Omitted unless it contains a value.
  if (!('encounter' in typed)) delete found.encounter
  const { simulator, scenario, criterion } = found
  const whole = isMapping(simulator) ? isMapping(criterion) && typeof criterion.result === 'string' : isMapping(scenario)
  return whole ? (found as unknown as Campaign) : null
}

/** A document with the defaults written out that a JSON schema states. */
function filled(value: Json, rule: Schema, all: Rules): Json {
  const choices = rulesOf(rule, all)
  if (Array.isArray(value)) {
    const items = choices.find((one) => one.items)?.items
    return items ? value.map((inner) => filled(inner, items, all)) : value
  }
  if (!isMapping(value) || rule.oneOf) return value
  const { properties = {}, patternProperties = {} } = choices.find((one) => one.properties ?? one.patternProperties) ?? {}
  const [any] = Object.values(patternProperties)
  const own = Object.entries(value).map(([key, inner]) => [key, filled(inner, properties[key] ?? any ?? {}, all)])
  const missing = Object.entries(properties).filter(([key, { default: usual }]) => !(key in value) && usual !== undefined)
  return Object.fromEntries([...own, ...missing.map(([key, { default: usual }]) => [key, structuredClone(usual)])]) as Json
}

/** Texts that may read like numbers. */
const TEXTS = new Set(['name', 'summary', 'notes', 'label', 'source'])
/** What the form does not edit, and shows at most as it is. */
const LOOSE = new Set(['requirements', 'encounter', 'regression', 'baseline'])

const isNumber = ({ type }: Schema): boolean => type === 'number' || type === 'integer'

/** Whether a value is of the kind that the schema states. A number may be any text, null or missing: the service reports it. */
function fits(value: unknown, rule: Schema, all: Rules, key = ''): boolean {
  const rules = rulesOf(rule, all)
  if (LOOSE.has(key)) return true
  if (Array.isArray(value)) return rules.some(({ items }) => items && value.every((inner) => fits(inner, items, all)))
  if (isMapping(value)) return rules.some((one) => one.type === 'object' && holds(value, one, all))
  if (value === null) return rules.some((one) => one.type === 'null' || isNumber(one))
  if (rules.some(isNumber)) return typeof value !== 'boolean'
  return rules.some(({ type }) => type === typeof value) || (typeof value === 'number' && TEXTS.has(key))
}

/** Whether a mapping has what is required, of the right kind; keys that the schema does not have are left to the service. */
function holds(value: Record<string, unknown>, rule: Schema, all: Rules): boolean {
  const { properties = {}, patternProperties = {}, additionalProperties: more, required = [] } = rule
  const other = Object.values(patternProperties)[0] ?? (typeof more === 'object' ? more : undefined)
  const needs = ([key, one]: [string, Schema]) => one.const !== undefined || (required.includes(key) && !rulesOf(one, all).some(isNumber))
  const complete = Object.entries(properties).filter(needs).every(([key]) => key in value)
  return complete && Object.entries(value).every(([key, inner]) => {
    const its = properties[key] ?? other
    return its === undefined || fits(inner, its, all, key)
  })
}
