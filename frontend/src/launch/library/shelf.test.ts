// Which cards of the library are shown.
import { describe, expect, it } from 'vitest'
import type { LibraryCampaign } from '../../client'
import { matching, ordered, shelfOf, tagsOf } from './shelf'

const item = (id: string, tags: string[]): LibraryCampaign =>
  ({
    id,
    document: {
      name: id.replace('_', ' '),
      tags,
      scenario: { vehicle: { component: 'v' }, controller: { component: 'c' }, avoider: { component: 'orca' } },
    },
  }) as unknown as LibraryCampaign

const LIBRARY = [
  item('pioneer_dropout', ['case-2', 'failure-condition']),
  item('pioneer_moving', ['case-2', 'published']),
  item('uav_bank', ['case-10', 'variant']),
  item('unicycle_static', ['case-1', 'published']),
  item('unicycle_two', []),
]
const ids = (items: LibraryCampaign[]) => items.map((one) => one.id)

it('puts what is published first, case by case', () => {
  expect(ids(ordered(LIBRARY))).toEqual(['unicycle_static', 'pioneer_moving', 'pioneer_dropout', 'uav_bank', 'unicycle_two'])
})

it('counts tags, cases last and in order', () => {
  expect(tagsOf(LIBRARY).map(({ tag, count }) => `${tag} ${count}`)).toEqual([
    'published 2', 'failure-condition 1', 'variant 1', 'case-1 1', 'case-2 2', 'case-10 1',
  ])
})

describe('matching', () => {
  it('needs the tag and every word', () => {
    const find = (tag: string | null, words: string) => ids(matching(LIBRARY, { tag, words }, undefined))
    expect(find('case-2', '')).toEqual(['pioneer_dropout', 'pioneer_moving'])
    expect(find(null, 'ORCA pioneer mov')).toEqual(['pioneer_moving'])
    expect(find(null, 'nothing')).toEqual([])
  })
})

it('begins with what is published only where there are many, and the chosen one is among them', () => {
  const many = [...LIBRARY, ...Array.from({ length: 8 }, (_, i) => item(`other_${i}`, []))]
  expect(shelfOf(many, 'unicycle_static').tag).toBe('published')
  expect(shelfOf(many, null).tag).toBe('published')
  expect(shelfOf(many, 'uav_bank').tag).toBeNull()
  expect(shelfOf(LIBRARY, 'unicycle_static').tag).toBeNull()
})
