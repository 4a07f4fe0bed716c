// A part of a run that could not be loaded is named; one that is empty, loading or only out of date is not.
import { expect, it, vi } from 'vitest'
import { insteadOf, listed, missingOf } from './missing'

const error = new Error('the database is locked')
const part = (changes: object) => ({ isError: false, data: undefined, error: null, refetch: vi.fn(), ...changes })

it('names what could not be loaded, and nothing else', () => {
  const found = missingOf({
    stages: part({ isError: true, error }),
    findings: part({ data: [] }),
    traces: part({}),
    evaluations: part({ isError: true, error, data: { stages: [] } }),
  })
  expect(found.map(({ name }) => name)).toEqual(['stages'])
  expect(found[0]?.error).toBe(error)
})

it('asks again for what is missing', () => {
  const refetch = vi.fn()
  missingOf({ stages: part({ isError: true, error, refetch }) })[0]?.retry()
  expect(refetch).toHaveBeenCalledOnce()
})

it('lists parts in a sentence', () => {
  expect(listed([{ name: 'stages' }])).toBe('stages')
  expect(listed([{ name: 'stages' }, { name: 'findings' }, { name: 'traces' }])).toBe('stages, findings and traces')
})

it('does not call loading what has failed', () => {
  expect(insteadOf([], 'evaluations')).toBe('Loading the evaluations …')
  expect(insteadOf([{ name: 'evaluations' }], 'evaluations')).toBe('The evaluations could not be loaded.')
})
