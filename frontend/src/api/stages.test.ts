// A stage's result by its kind.
import { expect, it } from 'vitest'
import { search, stage, validated } from '../../tests/fixtures'
import type { Sample } from '../client'
import { independentSample, randomSample, resultOf, resultWith } from './stages'

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

it('calls a sample independent only if it bounds the probability', () => {
  const sampled = (samples: number, upper_bound: number | null) => stage(search({ sample: { samples, upper_bound } as Sample }))
  const [extended, plain] = [sampled(60, null), sampled(300, 0.01)]
  expect(independentSample([extended])).toBeNull()
  expect(randomSample([extended])?.samples).toBe(60)
  for (const of of [independentSample, randomSample]) expect(of([extended, plain])?.samples).toBe(300)
  expect(randomSample([stage(null)])).toBeNull()
})
