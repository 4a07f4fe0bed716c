// The states of a sweep's runs in words.
import { expect, it } from 'vitest'
import { field } from '../format/numbers'
import { activeOf, statementOf } from './states'

it('counts what has not ended', () => {
  expect(activeOf({ queued: 2, running: 1, cancelling: 1, done: 3, cleared: 3 })).toBe(4)
  expect(activeOf({})).toBe(0)
})

it('names verdicts instead of done', () => {
  expect(statementOf({ done: 3, cleared: 2, violated: 1, queued: 2, failed: 1, purged: 1 })).toBe('2 queued, 2 cleared, 1 violated, 1 failed, 1 purged')
})

it('states how many of the cleared runs are contradicted', () => {
  expect(statementOf({ done: 3, cleared: 2, contradicted: 1, violated: 1 })).toBe('2 cleared, of these 1 contradicted, 1 violated')
})

it('shows values at full precision', () => {
  expect([field(0.1 + 0.2), field(-1)]).toEqual(['0.30000000000000004', '−1'])
})
