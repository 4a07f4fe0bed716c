// The OpenAPI document as parsed by the API page.
import { readFileSync } from 'node:fs'
import { expect, it } from 'vitest'
import { addressOf, curlOf, limitsOf, type OpenApi, operationsOf, partsOf, typeOf } from './openapi'

const DOCUMENT = JSON.parse(readFileSync(new URL('../../openapi.json', import.meta.url), 'utf8')) as OpenApi
const ALL = operationsOf(DOCUMENT).flatMap((group) => group.operations)
const operation = (id: string) => {
  const found = ALL.find((one) => one.operationId === id)
  if (!found) throw new Error(id)
  return found
}

it('has every operation once, under a described tag', () => {
  const paths = Object.values(DOCUMENT.paths).flatMap(Object.keys)
  expect(ALL).toHaveLength(paths.length)
  expect(operationsOf(DOCUMENT).every((group) => group.description !== '')).toBe(true)
})

it('names types that the document has', () => {
  const schemas = ALL.flatMap(({ parameters = [], responses, requestBody }) => [
    ...parameters.map((parameter) => parameter.schema),
    ...[requestBody?.content ?? {}, ...Object.values(responses).map((r) => r.content ?? {})].flatMap((content) =>
      Object.values(content).map((body) => body.schema),
    ),
  ])
  expect(schemas.length).toBeGreaterThan(50)
  for (const name of schemas.flatMap(partsOf)) expect(DOCUMENT.components.schemas).toHaveProperty(name)
})

it('describes types and limits in words', () => {
  expect(typeOf({ type: 'array', items: { $ref: '#/components/schemas/RunSummary' } })).toBe('list of RunSummary')
  expect(typeOf({ anyOf: [{ type: 'number' }, { type: 'null' }] })).toBe('number or null')
  expect(typeOf({ enum: ['low', 'high'] })).toBe('"low" | "high"')
  expect(typeOf({ type: 'object', additionalProperties: { type: 'number' } })).toBe('{name: number}')
  expect(limitsOf({ type: 'integer', minimum: 1, maximum: 200 })).toBe('1 to 200')
  expect(limitsOf({ anyOf: [{ type: 'string', maxLength: 128, minLength: 1 }, { type: 'null' }] })).toBe('1 to 128 characters')
  expect(limitsOf({ type: 'string' })).toBe('')
})

it('writes addresses', () => {
  expect(addressOf(operation('get_trace'), { run: 'R-0001', name: 'F 1', max_points: '50' })).toBe(
    '/api/v1/runs/R-0001/traces/F%201?max_points=50',
  )
  expect(addressOf(operation('get_run'), {})).toBe('/api/v1/runs/{run}')
})

it('writes the request for a shell', () => {
  expect(curlOf(operation('submit_run'), 'http://h', {})).toContain('--data-binary @campaign.yaml')
  expect(curlOf(operation('edit_run'), 'http://h', { run: 'R-0001' })).toContain("-X PATCH")
})
