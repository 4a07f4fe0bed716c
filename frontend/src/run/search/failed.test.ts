// Evaluations without a value: counted by kind, and as text for a campaign.
import { expect, it } from 'vitest'
import type { Evaluations } from '../../client'
import { countsOf, startsYaml } from './failed'

it('counts timeouts apart from the failed, among which the stages count them', () => {
  const evaluations = { stages: [{ timeouts: 2 }, { timeouts: 1 }] } as unknown as Evaluations
  const stages = [{ failed: 5, excluded: 0 }, { failed: 1, excluded: 4 }]
  expect(countsOf(stages, evaluations)).toEqual([
    { status: 'failed', count: 3 },
    { status: 'timeout', count: 3 },
    { status: 'excluded', count: 4 },
  ])
  expect(countsOf([{ failed: 1, excluded: 0 }], undefined)).toEqual([{ status: 'failed', count: 1 }])
})

it('writes every digit, as YAML reads numbers', () => {
  expect(startsYaml({ 'vehicle.m': 5.300000000000001, 'faults.0.sigma': 1e-7, 'start.x': -2.5e21 })).toBe(
    'starts:\n  - {vehicle.m: 5.300000000000001, faults.0.sigma: 1.0e-7, start.x: -2.5e+21}\n',
  )
})
