import { expect, it } from 'vitest'
import { boundsOf } from './schema'

it('states bounds in words, and names those that a value may not reach', () => {
  expect(boundsOf({ minimum: 1, maximum: 200 })).toBe('1 to 200')
  expect(boundsOf({ minimum: -0.5, maximum: 0.5 })).toBe('±0.5')
  expect(boundsOf({ exclusiveMinimum: 0, maximum: 1 })).toBe('above 0, at most 1')
  expect(boundsOf({ minimum: 0.9, exclusiveMaximum: 1 })).toBe('at least 0.9, below 1')
  expect(boundsOf({ minimum: 2 })).toBe('at least 2')
  expect(boundsOf({ anyOf: [{ type: 'number', exclusiveMinimum: 0, maximum: 1 }, { type: 'null' }] })).toBe('above 0, at most 1')
  expect(boundsOf({ type: 'string' })).toBe('')
})
