// Names of parameters: the same as those of the service (`tests/unit/campaigns/results/test_check_titles.py`).
import { expect, it } from 'vitest'
import { apart, nameOf, namesOf } from './names'

const PATHS = ['obstacles.0.position.y', 'start.y', 'faults.2.y', 'vehicle.y', 'vehicle.b', 'sim.y']

it('names the part that a shared symbol belongs to', () => {
  const found = namesOf(PATHS, new Map(PATHS.map((path) => [path, 'y'])))
  expect([...found.values()]).toEqual(['y of obstacle 1', 'y of the start', 'y of fault 3', 'vehicle.y', 'vehicle.b', 'sim.y'])
})

it('names a parameter by its symbol alone if no other has it, and by its path where its part has no name', () => {
  expect(namesOf(['vehicle.m', 'obstacles.1.x'], new Map([['vehicle.m', 'm'], ['obstacles.0.x', 'x'], ['obstacles.1.x', 'x']]))).toEqual(
    new Map([['vehicle.m', 'm'], ['obstacles.1.x', 'x of obstacle 2']]),
  )
  expect(nameOf('simulator.mass')).toBe('simulator.mass')
  expect(namesOf(['a.q', 'b.q'], new Map())).toEqual(new Map([['a.q', 'a.q'], ['b.q', 'b.q']]))
})

it('does not count the symbol of a threshold, which no catalogue has', () => {
  const own = [['criterion.threshold', 'c'], ['objectives.0.threshold', 'c']] as const
  expect(namesOf(['vehicle.drag'], new Map([['vehicle.drag', 'c'], ...own])).get('vehicle.drag')).toBe('c')
  expect(namesOf(['vehicle.drag'], new Map([['vehicle.drag', 'c'], ['faults.0.threshold', 'c']])).get('vehicle.drag')).toBe('c of the vehicle')
})

it('names a parameter without a symbol by the last part of its path', () => {
  expect(namesOf(['simulator.a'], new Map([['simulator.a', ''], ['simulator.b', '']])).get('simulator.a')).toBe('a')
  expect(namesOf(['vehicle.m'], new Map([['vehicle.m', ''], ['start.m', '']])).get('vehicle.m')).toBe('m of the vehicle')
})

it('separates the symbol of a name from its part', () => {
  expect(apart('omega_r of obstacle 1')).toEqual(['omega_r', ' of obstacle 1'])
})
