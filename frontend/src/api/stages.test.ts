// A stage's result by its kind.
import { expect, it } from 'vitest'
import { search, stage, validated } from '../../tests/fixtures'
import { resultOf, resultWith } from './stages'

it('gives the result of a stage of that kind, and of no other', () => {
  const searched = stage(search({ title: 'CMA-ES' }))
  expect(resultOf(searched, 'search')?.title).toBe('CMA-ES')
  expect(resultOf(searched, 'validate')).toBeNull()
  expect(resultOf(stage(validated({ tolerance: 0.01 })), 'validate')?.tolerance).toBe(0.01)
})

it('gives none while there is none', () => {
  expect(resultOf(stage(null, { kind: 'search' }), 'search')).toBeNull()
  expect(resultOf(undefined, 'search')).toBeNull()
})

it('finds a result by what it has', () => {
  const stages = [stage(null), stage(search({ title: 'CMA-ES' })), stage(validated({ tolerance: 0.01 }))]
  expect(resultWith(stages, 'tolerance')?.tolerance).toBe(0.01)
  expect(resultWith(stages, 'curves')).toBeNull()
})
