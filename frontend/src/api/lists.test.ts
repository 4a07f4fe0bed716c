// A list of several pages whose first page is requested again.
import { expect, it } from 'vitest'
import type { RunPage, RunSummary } from '../client'
import type { RunFilter } from './calls'
import { renewed } from './lists'

const page = (ids: string[], next: string | null, total = 0): RunPage => ({
  items: ids.map((id) => ({ id }) as RunSummary),
  next_cursor: next,
  counts: { total },
})
const ids = (pages: RunPage[]) => pages.map(({ items }) => items.map(({ id }) => id).join(' '))

it('puts new runs in front and loses none', () => {
  const data = { pages: [page(['d', 'c'], 'x'), page(['b', 'a'], null)], pageParams: [null, 'x'] }
  const after = renewed(data, page(['f', 'e'], 'y', 6))
  expect(ids(after.pages)).toEqual(['f e d c', 'b a'])
  expect(after.pages.map(({ next_cursor }) => next_cursor)).toEqual(['x', null])
  expect(after.pages[0]?.counts).toEqual({ total: 6 })
})

it('has no run twice when one moves to the front', () => {
  const data = { pages: [page(['d', 'c'], 'x'), page(['b', 'a'], null)], pageParams: [null, 'x'] }
  expect(ids(renewed(data, page(['a', 'd'], 'y')).pages)).toEqual(['a d c', 'b'])
})

it('leaves out what no longer belongs to the list', () => {
  const rows = (states: string[], removed: number | null = null) =>
    ({ ...page([], null), items: states.map((state, k) => ({ id: `${state}${k}`, state, verdict: null, removed }) as unknown as RunSummary) })
  const of = (filter: RunFilter, data: RunPage[]) => ids(renewed({ pages: data, pageParams: [] }, page(['new'], 'x'), filter).pages)
  expect(of({ state: ['queued'] }, [rows(['queued', 'done']), rows(['failed', 'queued'])])).toEqual(['new queued0', 'queued1'])
  expect(of({ verdict: ['cleared'] }, [rows(['done'])])).toEqual(['new'])
  expect(of({}, [rows(['done'], 5)])).toEqual(['new'])
  expect(of({ removed: true }, [rows(['done'], 5), rows(['done'])])).toEqual(['new done0', ''])
})
