// The parts of an OpenAPI 3.1 document that the API page uses.
import { boundsOf, type Schema, statedBy } from '../api/schema'

export interface Parameter {
  name: string
  in: 'path' | 'query' | 'header' | 'cookie'
  required?: boolean
  description?: string
  schema?: Schema
}

type Content = Record<string, { schema?: Schema }>

interface RawOperation {
  tags?: string[]
  operationId: string
  description?: string
  parameters?: Parameter[]
  requestBody?: { content: Content }
  responses: Record<string, { description?: string; content?: Content }>
  security?: unknown[]
}

export interface OpenApi {
  info: { title: string; version: string; summary?: string }
  tags?: { name: string; description?: string }[]
  paths: Record<string, Record<string, RawOperation>>
  components: { schemas: Record<string, Schema> }
}

export interface Operation extends RawOperation {
  method: string
  path: string
}

export interface Group {
  name: string
  description: string
  operations: Operation[]
}

/** The operations by their tag, in the document's order. */
export function operationsOf(document: OpenApi): Group[] {
  const all = Object.entries(document.paths).flatMap(([path, methods]) =>
    Object.entries(methods).map(([method, operation]): Operation => ({ ...operation, method, path })),
  )
  const descriptions = new Map(document.tags?.map((tag) => [tag.name, tag.description ?? '']))
  const names = [...new Set([...descriptions.keys(), ...all.map((operation) => operation.tags?.[0] ?? 'other')])]
  return names
    .map((name) => ({
      name,
      description: descriptions.get(name) ?? '',
      operations: all.filter((operation) => (operation.tags?.[0] ?? 'other') === name),
    }))
    .filter((group) => group.operations.length > 0)
}

export const nameOf = (schema: Schema | undefined): string | null => schema?.$ref?.split('/').pop() ?? null

/** A short description of a type, for a table column. */
export function typeOf(schema: Schema | undefined): string {
  if (!schema) return 'any'
  const named = nameOf(schema)
  if (named) return named
  const options = schema.anyOf ?? schema.oneOf
  if (options) return [...new Set(options.map(typeOf))].join(' or ')
  if (schema.const !== undefined) return JSON.stringify(schema.const)
  if (schema.enum) return schema.enum.map((value) => JSON.stringify(value)).join(' | ')
  if (schema.prefixItems) return `[${schema.prefixItems.map(typeOf).join(', ')}]`
  if (schema.type === 'array') return `list of ${typeOf(schema.items)}`
  if (schema.type === 'object' && typeof schema.additionalProperties === 'object')
    return `{name: ${typeOf(schema.additionalProperties)}}`
  return Array.isArray(schema.type) ? schema.type.join(' or ') : (schema.type ?? 'any')
}

/** The schemas that a type references. */
export function partsOf(schema: Schema | undefined): string[] {
  if (!schema) return []
  const named = nameOf(schema)
  if (named) return [named]
  const inner = [...(schema.anyOf ?? []), ...(schema.oneOf ?? []), ...(schema.prefixItems ?? [])]
  if (schema.items) inner.push(schema.items)
  if (typeof schema.additionalProperties === 'object') inner.push(schema.additionalProperties)
  return [...new Set(inner.flatMap(partsOf))]
}

/** The constraints of a value besides its type. */
export function limitsOf(schema: Schema = {}): string {
  const { minLength, maxLength, minItems, maxItems, pattern } = statedBy(schema)
  return [
    boundsOf(schema),
    range(minLength, maxLength, ' characters'),
    range(minItems, maxItems, ' items'),
    pattern && `matches ${pattern}`,
  ]
    .filter(Boolean)
    .join(', ')
}

function range(low: number | undefined, high: number | undefined, what: string): string {
  if (low !== undefined && high !== undefined) return `${low} to ${high}${what}`
  if (high !== undefined) return `at most ${high}${what}`
  return low ? `at least ${low}${what}` : ''
}

/** The address of an operation with these values; empty values are omitted from the query. */
export function addressOf(operation: Operation, values: Record<string, string>): string {
  let path = operation.path
  const query = new URLSearchParams()
  for (const { name, in: where } of operation.parameters ?? []) {
    const value = values[name] ?? ''
    if (where === 'path') path = path.replace(`{${name}}`, value ? encodeURIComponent(value) : `{${name}}`)
    else if (where === 'query' && value) query.append(name, value)
  }
  const text = query.toString()
  return text ? `${path}?${text}` : path
}

/** The request as a shell command. */
export function curlOf(operation: Operation, origin: string, values: Record<string, string>): string {
  const lines = [`curl -H "Authorization: Bearer $CLEARANCE_TOKEN"`]
  if (operation.method !== 'get') lines.push(`-X ${operation.method.toUpperCase()}`)
  const types = Object.keys(operation.requestBody?.content ?? {})
  const yaml = types.includes('application/yaml')
  if (types.length > 0)
    lines.push(
      `-H "Content-Type: ${yaml ? 'application/yaml' : types[0]}"`,
      yaml ? '--data-binary @campaign.yaml' : "-d '{…}'",
    )
  return [...lines, `'${origin}${addressOf(operation, values)}'`].join(' \\\n  ')
}
