// A JSON schema read along the path of a field. Source: JSON Schema 2020-12, as far as a campaign's uses it.
// Start reading at `ruleAt`.
import type { Json } from '../../api/campaign'
import type { At } from '../text/tree'

export interface Rule {
  $ref?: string
  $defs?: Record<string, Rule>
  anyOf?: Rule[]
  oneOf?: Rule[]
  properties?: Record<string, Rule>
  patternProperties?: Record<string, Rule>
  items?: Rule
  type?: string
  enum?: Json[]
  const?: Json
  default?: Json
  description?: string
  minimum?: number
  maximum?: number
  exclusiveMinimum?: number
  exclusiveMaximum?: number
}

/** A rule and those that it may also be. */
export function rulesOf(rule: Rule, all: Record<string, Rule> = rule.$defs ?? {}): Rule[] {
  const named = rule.$ref ? (all[rule.$ref.replace('#/$defs/', '')] ?? {}) : {}
  const choices = [...(rule.anyOf ?? []), ...(rule.oneOf ?? [])]
  return [rule, ...(rule.$ref ? rulesOf({ ...named, $defs: all }, all) : []), ...choices.flatMap((one) => rulesOf({ ...one, $defs: all }, all))]
}

/** What the schema says of a field; it brings the schema's definitions along. */
export function ruleAt(schema: Rule | undefined, at: At): Rule | undefined {
  const all = schema?.$defs ?? {}
  return at.reduce<Rule | undefined>((rule, step) => {
    const next = (rule ? rulesOf(rule, all) : []).flatMap((one) => {
      const inner = typeof step === 'number' ? one.items : (one.properties?.[step] ?? Object.values(one.patternProperties ?? {})[0])
      return inner ? [inner] : []
    })
    if (next.length === 0) return undefined
    return next.length === 1 ? { ...next[0], $defs: all } : { anyOf: next, $defs: all }
  }, schema)
}
