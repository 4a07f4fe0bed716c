// Which settings of two campaigns are reported as different.
import { describe, expect, it } from 'vitest'
import type { Catalogue, RunDetail } from '../client'
import { differences } from './differences'
import { idsOf, readCompare } from './search'

const parameter = (name: string, fallback: number, unit = '') => ({
  name,
  symbol: name,
  unit,
  low: -1e3,
  high: 1e3,
  default: fallback,
  text: `The ${name}`,
})
const component = (role: string, name: string, parameters: unknown[]) => ({
  ...{ role, name, title: name, dimension: 2, parameters, starts: [], goals: [], fits: [], text: '' },
})
const catalogue = {
  version: 'test',
  components: [
    component('vehicle', 'unicycle', [parameter('m', 5, 'kg')]),
    component('controller', 'pid', [parameter('k', 1)]),
    component('avoider', 'field', [parameter('r', 2)]),
    component('criterion', 'separation', []),
  ],
  methods: [],
} as unknown as Catalogue

const campaign = {
  name: 'One',
  scenario: {
    vehicle: { component: 'unicycle', parameters: { m: 5 } },
    controller: { component: 'pid' },
    avoider: { component: 'field' },
    goal: {},
    horizon: 15,
    step: 0.005,
  },
  uncertain: { 'vehicle.m': { plus_minus: '20%' } },
  criterion: { component: 'separation', threshold: 0.5 },
  stages: { search: [{ method: 'direct', evaluations: 100 }, { method: 'sqp', evaluations: 50 }] },
  seed: 1,
}
const run = (changed: (copy: typeof campaign) => void): RunDetail => {
  const copy = structuredClone(campaign)
  changed(copy)
  return { campaign: copy } as unknown as RunDetail
}
const differing = (...runs: RunDetail[]) =>
  differences(runs.map((run) => ({ run, catalogue })))
    .filter((row) => row.differs)
    .map((row) => [row.path, ...row.values])

describe('differences', () => {
  it('gives each run the default values that it was simulated with', () => {
    const later = structuredClone(catalogue)
    const changed = later.components.flatMap((c) => c.parameters).find((p) => p.name === 'k')
    Object.assign(changed ?? {}, { default: 3 })
    const same = run(() => undefined)
    const found = differences([{ run: same, catalogue }, { run: same, catalogue: later }])
    expect(found.filter((row) => row.differs).map((row) => [row.path, ...row.values])).toEqual([['controller.k', 1, 3]])
  })

  it('leaves words and spelt-out defaults out', () => {
    const other = run((copy) => {
      copy.name = 'Two'
      Object.assign(copy.scenario.controller, { parameters: { k: 1 } })
      copy.uncertain['vehicle.m'] = { low: 4, high: 6 } as never
    })
    expect(differing(run(() => undefined), other)).toEqual([])
  })
  it('names parameters by their path, with unit and words', () => {
    const other = run((copy) => (copy.scenario.vehicle.parameters.m = 6))
    const found = differences([run(() => undefined), other].map((run) => ({ run, catalogue }))).filter((row) => row.differs)
    expect(found.map((row) => row.path)).toEqual(['vehicle.m', 'uncertain.vehicle.m.low', 'uncertain.vehicle.m.high'])
    expect(found[0]).toMatchObject({ values: [5, 6], unit: 'kg', text: 'The m', group: 'Scenario' })
  })
  it('distinguishes searches by method, whatever their order', () => {
    const other = run((copy) => copy.stages.search.reverse())
    expect(differing(run(() => undefined), other)).toEqual([])
    const larger = run((copy) => (copy.stages.search = [{ method: 'direct', evaluations: 300 }]))
    expect(differing(run(() => undefined), larger)).toEqual([
      ['stages.search.direct.evaluations', 100, 300],
      ['stages.search.sqp.method', 'sqp', undefined],
      ['stages.search.sqp.evaluations', 50, undefined],
    ])
  })
  it('knows what only one of three has', () => {
    const other = run((copy) => (copy.criterion.threshold = 0.9))
    const three = [run(() => undefined), run(() => undefined), other]
    expect(differing(...three)).toEqual([['criterion.threshold', 0.5, 0.5, 0.9]])
  })
})

describe('the address', () => {
  it('gives ids, each once, at most four, and nothing else', () => {
    expect(idsOf('R-0001,R-0002,R-0001')).toEqual(['R-0001', 'R-0002'])
    expect(idsOf('R-1,x,<b>,R-2,R-3,R-4,R-5')).toEqual(['R-1', 'R-2', 'R-3', 'R-4'])
    expect(readCompare({ runs: 7 })).toEqual({ runs: undefined, all: undefined })
    expect(readCompare({ runs: 'R-0001,R-0002', all: true })).toEqual({ runs: 'R-0001,R-0002', all: true })
  })
})
