// What the pages read of a JSON Schema: of a campaign, of a method's options, of the API. Source: JSON Schema 2020-12.
import { exact } from '../format/numbers'
import type { Json } from './campaign'

export interface Schema {
  $ref?: string
  $defs?: Record<string, Schema>
  anyOf?: Schema[]
  oneOf?: Schema[]
  type?: string | string[]
  description?: string
  enum?: Json[]
  const?: Json
  default?: Json
  minimum?: number
  maximum?: number
  exclusiveMinimum?: number
  exclusiveMaximum?: number
  minLength?: number
  maxLength?: number
  minItems?: number
  maxItems?: number
  pattern?: string
  items?: Schema
  prefixItems?: Schema[]
  properties?: Record<string, Schema>
  patternProperties?: Record<string, Schema>
  additionalProperties?: Schema | boolean
  required?: string[]
}

/** The options of a method, by name. */
export const optionsOf = (method: { options: { properties?: unknown } } | undefined): Record<string, Schema> =>
  (method?.options.properties ?? {}) as Record<string, Schema>

/** A rule with what its first alternative besides null states. */
export const statedBy = (rule: Schema): Schema => ({ ...rule, ...rule.anyOf?.find((option) => option.type !== 'null') })

/** The bounds of a number in words; those that it may not reach are named so. Empty without any. */
export function boundsOf(rule: Schema): string {
  const { minimum, maximum, exclusiveMinimum, exclusiveMaximum } = statedBy(rule)
  if (minimum !== undefined && maximum !== undefined)
    return minimum === -maximum ? `±${exact(maximum)}` : `${exact(minimum)} to ${exact(maximum)}`
  const words: [string, number | undefined][] = [
    ['at least', minimum],
    ['above', exclusiveMinimum],
    ['at most', maximum],
    ['below', exclusiveMaximum],
  ]
  return words.flatMap(([word, value]) => (value === undefined ? [] : [`${word} ${exact(value)}`])).join(', ')
}
