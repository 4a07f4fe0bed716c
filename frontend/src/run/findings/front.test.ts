// The Pareto front over several searches.
import { expect, it } from 'vitest'
import * as fixtures from '../../../tests/fixtures'
import type { FrontCriterion, SearchResult } from '../../client'
import { criteriaOf, frontOf, someOf } from './front'

const CRITERIA: FrontCriterion[] = [
  { name: 'separation', title: 'Separation', quantity: 'd_min', unit: 'm', worse: 'low' },
  { name: 'goal_miss', title: 'Goal miss', quantity: 'd_goal', unit: 'm', worse: 'high' },
]

function search(method: string, values: [number, number][] | null, criteria = CRITERIA): SearchResult {
  const front = values?.map(([separation, goal_miss], index) => ({ index, parameters: {}, values: { separation, goal_miss } }))
  return fixtures.search({ method, title: method, criteria, front: front ?? null })
}

const shown = (searches: SearchResult[]) =>
  frontOf(searches, CRITERIA).map(({ method, values }) => `${method} ${values.separation} ${values.goal_miss}`)

it('keeps what no other search has found worse', () => {
  const one = search('a', [[1, 2], [2, 5], [4, 6]])
  const other = search('b', [[2, 4], [3, 7]])
  expect(shown([one, other])).toEqual(['a 1 2', 'a 2 5', 'b 3 7'])
  expect(shown([other, one])).toEqual(['a 1 2', 'a 2 5', 'b 3 7'])
})

it('shows equal points once, and nothing of a search without a front', () => {
  expect(shown([search('a', [[1, 2]]), search('b', [[1, 2]]), search('c', null)])).toEqual(['a 1 2'])
  expect(shown([])).toEqual([])
})

it('is of several criteria only', () => {
  expect(criteriaOf([search('a', null)])).toEqual([])
  expect(criteriaOf([search('a', [], CRITERIA.slice(0, 1))])).toEqual([])
  expect(criteriaOf([search('a', null), search('b', [[1, 2]])])).toEqual(CRITERIA)
})

it('is thinned with both ends', () => {
  expect(someOf([1, 2, 3], 5)).toEqual([1, 2, 3])
  expect(someOf([0, 1, 2, 3, 4, 5, 6, 7, 8], 3)).toEqual([0, 4, 8])
})
