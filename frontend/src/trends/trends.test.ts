// Texts and the address of trends.
import { expect, it } from 'vitest'
import type { TrendRun } from '../client'
import { rfc3339 } from '../format/time'
import { apart, axisOf } from './axis'
import { changesOf, differenceOf } from './code'
import { readTrend } from './search'

it('names what differs', () => {
  const code_changes = ['components/my_way.py', 'numpy', 'worker.engine.a', 'worker.engine.b']
  const of = (differs: ('seed' | 'code')[], code_known: boolean) => differenceOf({ differs, code_changes, code_known, seed: 7 })
  expect([of([], true), of(['seed'], true), of(['code'], true), of([], false), of(['seed'], false)]).toEqual([
    'nothing', 'seed 7', 'code: components/my_way.py, numpy, worker.engine.a and 1 more', 'code not known', 'seed 7, code not known',
  ])
})

it('names the runs before which the code changed, and what of it', () => {
  const runs = (changed: number[], code: string | null = 'a') =>
    [0, 1, 2, 3, 4].map((i) => ({ id: `R-${i}`, code_changed: changed.includes(i), code_changes: [`components/${i}.py`], code }))
  expect(changesOf(runs([1, 3]))).toBe('The code changed before R-1 (components/1.py), R-3 (components/3.py)')
  expect(changesOf(runs([1, 2, 3, 4]))).toBe(
    'The code changed before R-2 (components/2.py), R-3 (components/3.py), R-4 (components/4.py) and 1 earlier',
  )
  expect(changesOf(runs([]))).toBe('All runs used the same code')
  expect(changesOf(runs([], null))).toBe('No change of the code is known')
  expect(changesOf([...runs([]), ...runs([], 'b')])).toBe('No change of the code is known')
})

it('reads the address', () => {
  const digest = 'a'.repeat(64)
  expect(readTrend({ campaign: digest, name: 'x' })).toEqual({ campaign: digest })
  expect(readTrend({ campaign: 'x', name: 'y' })).toEqual({ name: 'y' })
  expect(readTrend({ campaign: 3 })).toEqual({})
  expect(readTrend({ name: 'y', along: 'order' })).toEqual({ name: 'y', along: 'order' })
  expect(readTrend({ name: 'y', along: 'sideways' })).toEqual({ name: 'y' })
  expect(readTrend({ name: 'y', label: 'branch=main' })).toEqual({ name: 'y', label: ['branch=main'] })
  expect(readTrend({ name: 'y', label: ['a=1', 'x', 3, 'a=1', 'b=2'] })).toEqual({ name: 'y', label: ['a=1', 'b=2'] })
  expect(readTrend({ campaign: digest, label: [] })).toEqual({ campaign: digest })
})

const at = (...times: number[]) =>
  times.map((created, i) => ({ id: `R-${i}`, created, finished: created + 5, code_changed: i === 1 })) as unknown as TrendRun[]

it('shows time where most runs are apart', () => {
  const day = 86_400
  expect(apart(at(0, day, 2 * day, 3 * day))).toBe(true)
  expect(apart(at(0, 1, 2, 3, 4, 5, 400 * day))).toBe(false)
  expect([apart(at()), apart(at(7)), apart(at(7, 7))]).toEqual([false, false, false])
})

it('places runs by the time of submission or by number, with the change of the code between two', () => {
  const runs = at(100, 300, 400)
  const time = axisOf(runs, 'time')
  expect(time.points.map(({ x }) => x)).toEqual([100, 300, 400])
  expect(time.axis.rules?.map(({ x }) => x)).toEqual([200])
  expect(time.axis.xText(300)).toBe(`R-1, submitted ${rfc3339(300)}`)
  const order = axisOf(runs, 'order')
  expect([order.points.map(({ x }) => x), order.axis.rules?.map(({ x }) => x), order.axis.xText(2)]).toEqual([
    [1, 2, 3], [1.5], `R-1, submitted ${rfc3339(300)}`,
  ])
})

it('writes times as RFC 3339 with the offset of the zone', () => {
  const written = rfc3339(1_795_000_000.9)
  expect(written).toMatch(/^2026-11-18T\d\d:\d\d:40[+-]\d\d:\d\d$/)
  expect(Date.parse(written) / 1000).toBe(1_795_000_000)
})
