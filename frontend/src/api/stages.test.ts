// A stage's result by what it has.
import { expect, it } from 'vitest'
import { search, stage, validated } from '../../tests/fixtures'
import type { Sample, StageDetail } from '../client'
import { independentSample, randomSample, resultsWith, resultWith, sampleTitle } from './stages'

type Result = StageDetail['result']

it('finds a result by what it has', () => {
  const stages = [stage(null), stage(search({ title: 'CMA-ES' })), stage(validated({ tolerance: 0.01 }))]
  expect(resultWith(stages, 'tolerance')?.tolerance).toBe(0.01)
  expect(resultWith(stages, 'curves')).toBeNull()
  expect(resultsWith([...stages, stage(search({ title: 'DIRECT' }))], 'minima').map(({ title }) => title)).toEqual(['CMA-ES', 'DIRECT'])
})

it('calls a sample independent only if it bounds the probability', () => {
  const sampled = (samples: number, upper_bound: number | null) => stage(search({ sample: { samples, upper_bound } as Sample }))
  const [extended, plain] = [sampled(60, null), sampled(300, 0.01)]
  expect(independentSample([extended])).toBeNull()
  expect(randomSample([extended])?.samples).toBe(60)
  for (const of of [independentSample, randomSample]) expect(of([extended, plain])?.samples).toBe(300)
  expect(randomSample([stage(null)])).toBeNull()
})

it('names a sample independent only if its seed was drawn at the launch', () => {
  const sample = { samples: 300, upper_bound: 0.01 } as Sample
  const certified = (drawn_at_launch: boolean, of = sample) => [stage({ grid: null, sample: of, drawn_at_launch } as Result)]
  expect(sampleTitle(certified(true), sample)).toBe('Independent sample')
  expect(sampleTitle(certified(false), sample)).toBe('Random sample')
  const ended = { ...sample, upper_bound: null }
  expect(sampleTitle(certified(true, ended), ended)).toBe('Random sample')
  expect(sampleTitle([stage(search({ sample }))], sample)).toBe('Random sample')
})
