// Looks up the path of a field in a JSON schema. Source: JSON Schema 2020-12, the subset used by campaigns.
import type { Schema } from '../../api/schema'
import type { At } from './tree'

/** A rule and its alternatives. */
export function rulesOf(rule: Schema, all: Record<string, Schema> = rule.$defs ?? {}): Schema[] {
  const named = rule.$ref ? (all[rule.$ref.replace('#/$defs/', '')] ?? {}) : {}
  const choices = [...(rule.anyOf ?? []), ...(rule.oneOf ?? [])]
  return [rule, ...(rule.$ref ? rulesOf({ ...named, $defs: all }, all) : []), ...choices.flatMap((one) => rulesOf({ ...one, $defs: all }, all))]
}

/** The schema of a field, with the definitions. */
export function ruleAt(schema: Schema | undefined, at: At): Schema | undefined {
  const all = schema?.$defs ?? {}
  return at.reduce<Schema | undefined>((rule, step) => {
    const next = (rule ? rulesOf(rule, all) : []).flatMap((one) => {
      const inner = typeof step === 'number' ? one.items : (one.properties?.[step] ?? Object.values(one.patternProperties ?? {})[0])
      return inner ? [inner] : []
    })
    if (next.length === 0) return undefined
    return next.length === 1 ? { ...next[0], $defs: all } : { anyOf: next, $defs: all }
  }, schema)
}
