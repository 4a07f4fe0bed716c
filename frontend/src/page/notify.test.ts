// Notifications of ended runs.
import { afterAll, beforeAll, expect, it, vi } from 'vitest'
import type { RunSummary } from '../client'
import type * as Notify from './notify'

let notify: typeof Notify

beforeAll(async () => {
  // The module listens to changes of other tabs.
  vi.stubGlobal('addEventListener', () => undefined)
  notify = await import('./notify')
})
afterAll(() => {
  vi.unstubAllGlobals()
})

it('reads whatever is stored', () => {
  expect(notify.readWanted(null)).toEqual({ mine: false, runs: [] })
  expect(notify.readWanted('no json')).toEqual({ mine: false, runs: [] })
  expect(notify.readWanted('{"mine": true, "runs": ["R-0001", 7]}')).toEqual({ mine: true, runs: ['R-0001'] })
  expect(notify.readWanted('{"mine": "yes", "runs": "R-0001"}')).toEqual({ mine: false, runs: [] })
})

it('finds those that are live no more', () => {
  const live = [{ id: 'R-0002' }, { id: 'R-0003' }] as RunSummary[]
  expect(notify.endedOf(new Set(['R-0001', 'R-0002']), live)).toEqual(['R-0001'])
  expect(notify.endedOf(new Set(), live)).toEqual([])
})

it('states the outcome', () => {
  const run = { name: 'Release', token: null, margin: -2.3, unit: 'm', error: null, verdict: 'violated' as const }
  expect(notify.bodyOf(run)).toBe('Release: margin \u22122.300 m')
  expect(notify.bodyOf({ ...run, verdict: null, error: 'diverged' })).toBe('Release: diverged')
  expect(notify.bodyOf({ ...run, verdict: null })).toBe('Release')
  expect(notify.bodyOf({ ...run, token: 'nightly' })).toBe('Release (token nightly): margin \u22122.300 m')
})
