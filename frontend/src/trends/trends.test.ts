// Texts and the address of trends.
import { expect, it } from 'vitest'
import { changesOf } from './changes'
import { differenceOf } from './difference'
import { readTrend } from './search'

it('names what differs', () => {
  const of = (differs: ('seed' | 'code')[], code_known: boolean) => differenceOf({ differs, code_known, seed: 7 })
  expect([of([], true), of(['seed'], true), of(['code'], true), of([], false), of(['seed'], false)]).toEqual([
    'nothing', 'seed 7', 'code', 'code not known', 'seed 7, code not known',
  ])
})

it('names the runs before which the code changed', () => {
  const runs = (changed: number[], code: string | null = 'a') =>
    [0, 1, 2, 3, 4].map((i) => ({ id: `R-${i}`, code_changed: changed.includes(i), code }))
  expect(changesOf(runs([1, 3]))).toBe('The code changed before R-1, R-3')
  expect(changesOf(runs([1, 2, 3, 4]))).toBe('The code changed before R-2, R-3, R-4 and 1 earlier')
  expect(changesOf(runs([]))).toBe('One code ran all of them')
  expect(changesOf(runs([], null))).toBe('No change of the code is known')
})

it('reads the address', () => {
  const digest = 'a'.repeat(64)
  expect(readTrend({ campaign: digest, name: 'x' })).toEqual({ campaign: digest })
  expect(readTrend({ campaign: 'x', name: 'y' })).toEqual({ name: 'y' })
  expect(readTrend({ campaign: 3 })).toEqual({})
})
