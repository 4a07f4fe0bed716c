// Provenance of a run, from its verdict and from what was stored at its start.
import { expect, it } from 'vitest'
import { verdict } from '../../tests/fixtures'
import type { Catalogue, Versions } from '../client'
import { originOf, titleOf } from './provenance/Provenance'

const { provenance: NOTHING } = verdict()
const FLOWN: Versions = { ...NOTHING, code: 'c0de', loop: 'abcd', packages: { numpy: '2.4.6' }, lanes: 8 }

it('takes what the verdict does not state from what was stored as the run began', () => {
  const summary = verdict({ provenance: { ...NOTHING, seed: 7, loop: 'beef', packages: { numpy: '2.5.0' } } })
  const origin = originOf({ summary, flown: FLOWN })
  expect([origin.seed, origin.loop, origin.code, origin.lanes]).toEqual([7, 'beef', 'c0de', 8])
  expect(origin.packages).toEqual({ numpy: '2.5.0' })
})

it('has the versions of a run without a verdict, and nothing where nothing was stored', () => {
  expect(originOf({ summary: null, flown: FLOWN })).toMatchObject({ code: 'c0de', seed: null, cpu: null })
  expect(originOf({ summary: null, flown: null })).toEqual(NOTHING)
})

it('calls a part by its title, and by its name in files only if it is not described', () => {
  const components = [{ role: 'controller', name: 'pid_speed', title: 'PID of speed' }, { role: 'vehicle', name: 'pid_speed', title: 'Another' }]
  const catalogue = { components, simulators: [{ name: 'drop', title: 'Falling body' }], methods: [] } as unknown as Catalogue
  expect(titleOf(catalogue, 'controller', 'pid_speed')).toBe('PID of speed')
  expect(titleOf(catalogue, 'simulator', 'drop')).toBe('Falling body')
  expect([titleOf(catalogue, 'avoider', 'ge_cui'), titleOf(undefined, 'vehicle', 'unicycle')]).toEqual(['ge_cui', 'unicycle'])
})
