// A list of several pages whose first page is requested again.
import { expect, it } from 'vitest'
import type { RunPage, RunSummary } from '../client'
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
