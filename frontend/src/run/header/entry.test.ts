// Texts of the audit trail.
import { expect, it } from 'vitest'
import type { HistoryEntry } from '../../client'
import { statementOf } from './entry'

const entry = (action: string, detail: HistoryEntry['detail'] = {}) =>
  statementOf({ at: 0, user: 'ada', account: 'ada', via: 'link', action, detail })

it('describes what an edit changed', () => {
  expect(entry('run.edited', { pinned: true })).toBe('Pinned it')
  expect(entry('run.edited', { name: 'B', tags: ['a', 'b'], notes: {} })).toBe('Named it “B”; tagged it a, b; wrote its notes')
  expect(entry('run.edited', { tags: [] })).toBe('Removed its tags')
})

it('states who signed, and why it was withdrawn', () => {
  expect(entry('signoff.created', { name: 'Ada', role: 'Assessor' })).toBe('Signed off as Ada, Assessor')
  expect(entry('signoff.withdrawn', { reason: 'too early' })).toBe('Withdrew a sign-off: too early')
})

it('states whether a cancellation was in time', () => {
  expect(entry('run.cancelled', { state: 'cancelling' })).toBe('Cancelled')
  expect(entry('run.cancelled', { state: 'done' })).toBe('Requested cancellation after its end')
})

it('describes the outcome of a run', () => {
  expect(entry('run.removed', { reason: 'a trial' })).toBe('Removed it from the lists: a trial')
  expect(entry('run.restored', { reason: 'a trial' })).toBe('Restored it')
  expect(entry('run.purged', { results_digest: '0123456789abcdef01' })).toBe('Permanently deleted its results, sha256 0123456789abcdef')
})

it('states whether a run that was tried again kept its evaluations', () => {
  const sentences = [{ evaluations: 100 }, { evaluations: 0, discarded: 15 }].map((detail) => entry('run.retried', detail))
  expect(sentences.map((sentence) => sentence.includes('without'))).toEqual([false, true])
})

it('hides nothing that it has no words for', () => {
  expect(entry('run.something')).toBe('run.something')
})
