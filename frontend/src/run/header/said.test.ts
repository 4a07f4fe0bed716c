// Texts of the audit trail.
import { expect, it } from 'vitest'
import type { HistoryEntry } from '../../client'
import { saidOf } from './said'

const said = (action: string, detail: HistoryEntry['detail'] = {}) =>
  saidOf({ at: 0, user: 'ada', via: 'link', action, detail })

it('describes what an edit changed', () => {
  expect(said('run.edited', { pinned: true })).toBe('Pinned it')
  expect(said('run.edited', { name: 'B', tags: ['a', 'b'], notes: {} })).toBe('Named it “B”; tagged it a, b; wrote its notes')
  expect(said('run.edited', { tags: [] })).toBe('Removed its tags')
})

it('states who signed, and why it was withdrawn', () => {
  expect(said('signoff.created', { name: 'Ada', role: 'Assessor' })).toBe('Signed off as Ada, Assessor')
  expect(said('signoff.withdrawn', { reason: 'too early' })).toBe('Withdrew a sign-off: too early')
})

it('states whether a cancellation was in time', () => {
  expect(said('run.cancelled', { state: 'cancelling' })).toBe('Cancelled')
  expect(said('run.cancelled', { state: 'done' })).toBe('Requested cancellation after its end')
})

it('describes the outcome of a run', () => {
  expect(said('run.removed', { reason: 'a trial' })).toBe('Removed it from the lists: a trial')
  expect(said('run.restored', { reason: 'a trial' })).toBe('Restored it')
  expect(said('run.purged', { results_digest: '0123456789abcdef01' })).toBe('Permanently deleted its results, sha256 0123456789abcdef')
})

it('hides nothing that it has no words for', () => {
  expect(said('run.something')).toBe('run.something')
})
