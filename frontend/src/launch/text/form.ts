// Shows an incomplete or invalid text in the form, as far as its structure is that of a campaign.
import type { Campaign, Json } from '../../api/campaign'
import { parsed, plain } from './tree'
import { isMapping } from './words'

/** The approximate campaign of a text, with the schema's defaults; null if the form cannot show it. */
export function formOf(text: string, schema: unknown): Campaign | null {
  const tree = parsed(text)
  const typed = tree && plain(tree)
  const found: unknown = typed && filled(typed, schema as Rule, (schema as Rule).$defs ?? {})
  // Omitted unless it contains a value.
  if (isMapping(typed) && isMapping(found) && !('encounter' in typed)) delete (found as Record<string, Json>).encounter
  return isForm(found) ? found : null
}

interface Rule {
  $ref?: string
  $defs?: Record<string, Rule>
  anyOf?: Rule[]
  properties?: Record<string, Rule>
  patternProperties?: Record<string, Rule>
  items?: Rule
  default?: Json
}

/** A document with the defaults written out that a JSON schema states. */
function filled(value: Json, given: Rule, all: Record<string, Rule>): Json {
  const named = (rule: Rule): Rule => (rule.$ref ? (all[rule.$ref.replace('#/$defs/', '')] ?? {}) : rule)
  const choices = [given, ...(given.anyOf ?? [])].map(named)
  if (Array.isArray(value)) {
    const items = choices.find((rule) => rule.items)?.items
    return items ? value.map((inner) => filled(inner, items, all)) : value
  }
  if (!isMapping(value)) return value
  const { properties = {}, patternProperties = {} } = choices.find((r) => r.properties ?? r.patternProperties) ?? {}
  const [any] = Object.values(patternProperties)
  const ruleOf = (key: string) => properties[key] ?? any
  const own = Object.entries(value).map(([key, inner]) => [key, filled(inner, ruleOf(key) ?? {}, all)])
  const missing = Object.entries(properties).filter(([key, rule]) => !(key in value) && rule.default !== undefined)
  return Object.fromEntries([...own, ...missing.map(([key, rule]) => [key, structuredClone(rule.default)])]) as Json
}

type Fits = (value: unknown) => boolean

const raw: Fits = (value) => typeof value === 'number' || typeof value === 'string'
const words: Fits = (value) => typeof value === 'string'
const any: Fits = () => true
const orNull =
  (fits: Fits): Fits =>
  (value) =>
    value === null || fits(value)
const listOf =
  (fits: Fits): Fits =>
  (value) =>
    Array.isArray(value) && value.every(fits)
const mapOf =
  (fits: Fits): Fits =>
  (value) =>
    isMapping(value) && Object.values(value).every(fits)
/** A mapping whose keys fit where they are there; those with a star have to be. Others are left to the service. */
const record =
  (shape: Record<string, Fits>): Fits =>
  (value) =>
    isMapping(value) &&
    Object.entries(shape).every(([name, fits]) => {
      const key = name.replace('*', '')
      return key in value ? fits(value[key]) : key === name
    })

const part = record({ 'component*': words, parameters: mapOf(raw), on: words })
const distribution = record({ 'kind*': words, mean: raw, deviation: raw, mode: raw, alpha: raw, beta: raw })
const bounds = record({ low: orNull(raw), high: orNull(raw), plus_minus: orNull(raw), unit: orNull(words), distribution })
const numbers = mapOf(orNull(raw))

const FORM = record({
  'name*': raw,
  summary: raw,
  notes: raw,
  tags: listOf(words),
  scenario: record({
    'vehicle*': part,
    'controller*': part,
    'avoider*': part,
    start: mapOf(raw),
    'goal*': mapOf(raw),
    obstacles: listOf(part),
    environment: listOf(part),
    faults: listOf(part),
    realisations: record({ seeds: listOf(raw), combine: words }),
    guidance: record({ period: orNull(raw) }),
    horizon: orNull(raw),
    step: orNull(raw),
  }),
  'uncertain*': mapOf(bounds),
  correlations: listOf(record({ 'between*': listOf(words), value: raw })),
  simulator: record({ 'name*': words, parameters: mapOf(raw) }),
  'criterion*': record({ component: words, result: words, parameters: mapOf(raw), threshold: orNull(raw) }),
  objectives: listOf(part),
  'stages*': record({
    sensitivity: orNull(record({ points: orNull(raw), morris: orNull(numbers), sobol: orNull(numbers) })),
    'search*': listOf(
      record({ 'method*': words, evaluations: orNull(raw), options: mapOf(any), starts: listOf(mapOf(raw)) }),
    ),
    certify: orNull(record({ samples: orNull(raw), quantile: orNull(raw), grid: orNull(numbers) })),
    findings: numbers,
    validate: numbers,
  }),
  agreement: orNull(raw),
  target_probability: orNull(raw),
  confidence: orNull(raw),
  seed: orNull(raw),
  published: listOf(record({ 'label*': raw, value: orNull(raw), at: mapOf(raw), source: raw })),
})

/** Whether the form can show it: all containers exist and have the right type. */
const SCENARIO = record({ 'scenario*': any, 'criterion*': record({ 'component*': words }) })
const SIMULATOR = record({ 'simulator*': any, 'criterion*': record({ 'result*': words }) })

/** Of a scenario or of a simulator, which excludes one. */
const isForm = (value: unknown): value is Campaign =>
  FORM(value) && (isMapping(value) && 'simulator' in value ? SIMULATOR(value) : SCENARIO(value))
