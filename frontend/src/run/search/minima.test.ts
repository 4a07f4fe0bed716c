// Minima are merged as the findings are.
import { expect, it } from 'vitest'
import { finding } from '../../../tests/fixtures'
import type { Minimum } from '../../client'
import { basinsOf, mergedMinima, rangesText } from './minima'

const minimum = (cost: number, m: number): Minimum => ({
  cost, evaluations: 10, parameters: { m }, start: { m: 0 }, point: [], statement: [], text: '',
})
const PARAMETERS = [{ path: 'm', low: 0, high: 10 }]
const summaries = (minima: Minimum[], basins: (string | null)[] = [], findings = [finding('F1', { parameters: { m: 1 } })]) =>
  mergedMinima(minima, basins, findings, PARAMETERS, 0.03).map(({ lowest, descents, evaluations, finding: label }) => [label, lowest.cost, descents, evaluations])

it('makes one minimum of all descents into the basin of a finding, however far apart they ended', () => {
  const minima = [minimum(0.5, 1), minimum(0.7, 4), minimum(0.4, 9)]
  expect(summaries(minima, ['F1', 'F2', 'F1'])).toEqual([['F1', 0.4, [1, 3], 20], ['F2', 0.7, [2], 10]])
})

it('merges the others only where they are close, and never with a finding', () => {
  const minima = [minimum(0.5, 1), minimum(0.9, 5), minimum(0.8, 5.2), minimum(0.95, 6)]
  expect(summaries(minima, ['F1', null, null, null])).toEqual([['F1', 0.5, [1], 10], [null, 0.8, [2, 3], 20], [null, 0.95, [4], 10]])
})

it('goes by the distance from the findings where validation stored no basins', () => {
  expect(summaries([minimum(0.5, 1.1), minimum(0.6, 1.2), minimum(0.7, 4)])).toEqual([['F1', 0.5, [1, 2], 20], [null, 0.7, [3], 10]])
  expect(summaries([], [])).toEqual([])
  expect(summaries([minimum(0.5, 1), minimum(0.5, NaN)], [], [])).toHaveLength(2)
})

it('finds the basins of a search by its position', () => {
  const row = { position: 4, method: 'sqp', title: 'SQP', kind: 'local' as const, best: 1, evaluations: 1, failed: 0, excluded: 0, seconds: 1, to_near_best: null, basin: 'F1', findings: [], stop: null }
  expect(basinsOf([{ ...row, minima: ['F1', null] }], 4)).toEqual(['F1', null])
  expect([basinsOf([row], 4), basinsOf([], 4), basinsOf(undefined, 4)]).toEqual([[], [], []])
})

it('lists numbers as ranges', () => {
  expect([rangesText([1, 3, 4, 5, 6, 9]), rangesText([1, 2]), rangesText([])]).toEqual(['1, 3 to 6, 9', '1, 2', ''])
})
