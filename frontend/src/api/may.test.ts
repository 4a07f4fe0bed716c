import { expect, test } from 'vitest'
import type { SessionInfo } from '../client'
import { barredFrom, barredFromOwn } from './may'

test('a button says which role it needs', () => {
  expect(barredFrom('viewer', 'engineer')).toBe('This needs the role engineer; yours is viewer.')
  expect(barredFrom('reviewer', 'admin')).toBe('This needs the role admin; yours is reviewer.')
})

test('nothing is barred from a role that has it, nor while the role is not known', () => {
  expect(barredFrom('reviewer', 'engineer')).toBeUndefined()
  expect(barredFrom('admin', 'admin')).toBeUndefined()
  expect(barredFrom(undefined, 'admin')).toBeUndefined()
})

const as = (account: string, role: SessionInfo['role']): SessionInfo => ({ user: account, account, role, via: 'password', scope: null, has_password: true })
const run = (owner: string) => ({ id: 'R-0001', owner })
const REASON = 'R-0001 belongs to ada, and you are bob: only its owner and an administrator may change it.'

// The rule of backend/access/own.py.
test.each([
  ['the owner', as('ada', 'engineer'), [run('ada')], undefined],
  ['an administrator', as('eve', 'admin'), [run('ada')], undefined],
  ['no engineer of what has no owner', as('bob', 'engineer'), [], undefined],
  ['not another engineer', as('bob', 'engineer'), [run('ada')], REASON],
  ['not a reviewer, whose role is higher', as('bob', 'reviewer'), [run('ada')], REASON],
  ['not whoever owns one of two', as('bob', 'engineer'), [{ id: 'R-0002', owner: 'bob' }, run('ada')], REASON],
  ['not the former owner, whose role is lower now', as('ada', 'viewer'), [run('ada')], 'This needs the role engineer; yours is viewer.'],
] as const)('what belongs to one is changed by %s', (_, session, things, barred) => {
  expect(barredFromOwn(session, 'engineer', things)).toBe(barred)
})

test('what is not known yet is offered', () => {
  expect(barredFromOwn(undefined, 'engineer', [run('ada')])).toBeUndefined()
})
