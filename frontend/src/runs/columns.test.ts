// Which columns the run list shows, and its orders.
import { expect, it } from 'vitest'
import * as fixtures from '../../tests/fixtures'
import { COLUMNS, columnsOf, sortOf, statedOf } from './columns'

const keys = (...of: Parameters<typeof columnsOf>) => columnsOf(...of).map(({ key }) => key)

it('shows the columns of an address in their own order and leaves out what it does not know', () => {
  expect(keys(['tags', 'worst', 'x'], false)).toEqual(['worst', 'tags'])
  expect(keys([], false)).toEqual([])
})

it('leaves out columns for which a list is too narrow, unless they are asked for', () => {
  expect(keys(undefined, false)).toContain('owner')
  expect(keys(undefined, false, 1000)).not.toContain('owner')
  expect(keys(['owner'], false, 1000)).toEqual(['owner'])
  expect(keys(undefined, true)).toEqual(['verdict', 'worst', 'margin', 'tags', 'submitted'])
})

it('takes an order that it does not know for that of the list, which no address states', () => {
  expect([sortOf('-bound'), sortOf('name'), sortOf('colour'), sortOf(undefined)]).toEqual(['-bound', 'name', '-created', '-created'])
  expect([statedOf('-created'), statedOf('created')]).toEqual([undefined, 'created'])
})

it('has the campaign beside the number of a run only where it has another name', () => {
  const aside = COLUMNS.find(({ key }) => key === 'campaign')?.aside
  expect(aside?.(fixtures.run({ name: 'a', campaign_name: 'b' }))).toBe('b')
  expect(aside?.(fixtures.run({ name: 'b', campaign_name: 'b' }))).toBe(false)
})
