// Improvements from the event stream are appended to those already loaded.
import { QueryClient } from '@tanstack/react-query'
import { expect, it } from 'vitest'
import type { EvaluationSeries, RunSummary, StageProgress } from '../client'
import { extended, putImprovements, putRun, putStages } from './events'

const SERIES = {
  total: 3,
  index: [0, 2],
  seconds: [0.1, 0.3],
  cost: [5, 4],
  status: ['ok', 'ok'],
  further: { goal_miss: [8, 9] },
  parameters: { 'vehicle.m': [1, 2] },
  improvements: { index: [0, 2], seconds: [0.1, 0.3], cost: [5, 4] },
} as unknown as EvaluationSeries

const fresh = (index: number[], cost: number[], parameters: Record<string, number> = {}) => ({
  index,
  cost,
  seconds: index.map((i) => 0.1 * (i + 1)),
  evaluations: 9,
  parameters,
})

it('has the best with its parameters, and every improvement', () => {
  const after = extended(SERIES, fresh([5, 7], [3, 2], { 'vehicle.m': 6 }))
  expect(after.improvements).toMatchObject({ index: [0, 2, 5, 7], cost: [5, 4, 3, 2] })
  expect(after).toMatchObject({ total: 9, index: [0, 2, 7], cost: [5, 4, 2], parameters: { 'vehicle.m': [1, 2, 6] } })
  expect(after.further).toEqual({ goal_miss: [8, 9, null] })
})

it('takes nothing twice', () => {
  const once = extended(SERIES, fresh([5], [3], { 'vehicle.m': 6 }))
  expect(extended(once, fresh([0, 2, 5], [5, 4, 3], { 'vehicle.m': 6 }))).toEqual(once)
})

it('shows no flight whose parameters it does not know', () => {
  expect(extended(SERIES, fresh([5], [3])).index).toEqual([0, 2])
})

it('writes a run into the paged lists, and leaves queries of other shapes alone', () => {
  const cache = new QueryClient()
  const run = { id: 'R-0001', state: 'running', name: 'new' } as unknown as RunSummary
  const old = { ...run, name: 'old' }
  cache.setQueryData(['runs', { q: '' }], { pages: [{ items: [old] }], pageParams: [null] })
  for (const [i, other] of [{ items: [old] }, [old], null, 3].entries()) cache.setQueryData(['runs', 'other', i], other)
  putRun(cache, run)
  expect(cache.getQueryData(['runs', { q: '' }])).toEqual({ pages: [{ items: [run] }], pageParams: [null] })
  expect(cache.getQueryData(['runs', 'other', 0])).toEqual({ items: [old] })
  expect(cache.getQueryData(['runs', 'other', 1])).toEqual([old])
})

it('reads lists and counts again when the state of a listed run changes, and only then', () => {
  const cache = new QueryClient()
  const run = { id: 'R-0001', state: 'running', name: 'new' } as unknown as RunSummary
  const listed = (item: RunSummary) => {
    cache.setQueryData(['runs', { q: '' }], { pages: [{ items: [item] }], pageParams: [null] })
    putRun(cache, run)
    return cache.getQueryState(['runs', { q: '' }])?.isInvalidated
  }
  expect(listed({ ...run, name: 'old' })).toBe(false)
  expect(listed({ ...run, state: 'queued' })).toBe(true)
})

it('reads evaluations, findings and flights again once the run was reset, and only then', () => {
  const keys = ['evaluations', 'findings', 'traces', 'trace', 'stages']
  const invalidated = (stages: { position: number; started: number | null }[]) => {
    const cache = new QueryClient()
    for (const key of keys) cache.setQueryData([key, 'R-0001'], { stages: [{ position: 2, started: 5 }] })
    putStages(cache, 'R-0001', stages as StageProgress[])
    return keys.filter((key) => cache.getQueryState([key, 'R-0001'])?.isInvalidated)
  }
  expect(invalidated([{ position: 2, started: 5 }, { position: 3, started: 6 }])).toEqual([])
  expect(invalidated([])).toEqual(keys)
  expect(invalidated([{ position: 2, started: null }])).toEqual(keys)
  expect(invalidated([{ position: 2, started: 7 }])).toEqual(keys)
})

it('improvements of a stage that is not known do not restart the request that will know it', async () => {
  const cache = new QueryClient()
  const key = ['evaluations', 'R-0001']
  const news = { 4: fresh([5], [3]) }
  cache.setQueryData(key, { criteria: [], stages: [], failures: [] })
  cache.setQueryData([...key, 'points', true], { criteria: [], stages: [], failures: [] })
  const requests: ((answer: object) => void)[] = []
  const request = cache.fetchQuery({ queryKey: key, queryFn: () => new Promise<object>((resolve) => requests.push(resolve)) })
  putImprovements(cache, 'R-0001', news)
  expect(cache.getQueryState(key)?.isInvalidated).toBe(false)
  requests[0]?.({ criteria: [], stages: [], failures: [] })
  await request
  putImprovements(cache, 'R-0001', news)
  expect(cache.getQueryState(key)?.isInvalidated).toBe(true)
  expect(cache.getQueryState([...key, 'points', true])?.isInvalidated).toBe(false)
})
