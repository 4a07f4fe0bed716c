import { expect, test } from 'vitest'
import { barredFrom } from './may'

test('a button says which role it needs', () => {
  expect(barredFrom('viewer', 'engineer')).toBe('This needs the role engineer; yours is viewer.')
  expect(barredFrom('reviewer', 'admin')).toBe('This needs the role admin; yours is reviewer.')
})

test('nothing is barred from a role that has it, nor while the role is not known', () => {
  expect(barredFrom('reviewer', 'engineer')).toBeUndefined()
  expect(barredFrom('admin', 'admin')).toBeUndefined()
  expect(barredFrom(undefined, 'admin')).toBeUndefined()
})
