// Labels of parameters.
import { expect, it } from 'vitest'
import type { Campaign } from '../../api/campaign'
import type { Catalogue, Evaluations } from '../../client'
import { finding, flight, head, progress, run } from '../../../tests/fixtures'
import { bestOf, finderOf, leaderOf, leavesGround, rateOf, uncertainOf } from './data'

const parameter = (name: string, symbol: string) => ({
  name,
  symbol,
  unit: '',
  low: 0,
  high: 9,
  default: 1,
  text: name,
})
const CATALOGUE = {
  version: '',
  methods: [],
  components: [
    { role: 'vehicle', name: 'v', title: '', dimension: 2, text: '', parameters: [parameter('m', 'm'), parameter('r', 'r')] },
    { role: 'obstacle', name: 'o', title: '', dimension: 2, text: '', parameters: [parameter('speed', 'u_0'), parameter('r', 'r')] },
  ],
} as unknown as Catalogue

it('names the part that parameters of one symbol belong to', () => {
  const part = { component: 'any' }
  const bounds = { low: 0, high: 2 }
  const paths = ['vehicle.m', 'vehicle.r', 'obstacles.0.r', 'obstacles.0.speed', 'obstacles.1.speed']
  const campaign = {
    scenario: { vehicle: { component: 'v' }, controller: part, avoider: part, goal: {}, obstacles: [{ component: 'o' }, { component: 'o' }] },
    criterion: { component: 'c', threshold: 1 },
    uncertain: Object.fromEntries(paths.map((path) => [path, bounds])),
  } as unknown as Campaign
  expect(uncertainOf(campaign, CATALOGUE).map(({ symbol, text }) => `${symbol}: ${text}`)).toEqual([
    'm: m',
    'r of the vehicle: r',
    'r of obstacle 1: r',
    'u_0 of obstacle 1: speed',
    'u_0 of obstacle 2: speed',
  ])
})

it('calls parameters of a simulator that have no symbol by their names', () => {
  const parameters = [parameter('mass', ''), parameter('wind', '')]
  const known = { ...CATALOGUE, simulators: [{ name: 'drop', title: 'Drop', text: '', parameters, results: [] }] } as unknown as Catalogue
  const campaign = {
    simulator: { name: 'drop' },
    criterion: { result: 'd', threshold: 1 },
    uncertain: { 'simulator.mass': { low: 0, high: 2 }, 'simulator.wind': { low: 0, high: 2 } },
  } as unknown as Campaign
  expect(uncertainOf(campaign, known).map(({ symbol }) => symbol)).toEqual(['mass', 'wind'])
})

it('names a method for the worst finding that found it, not merely the one with the lowest value', () => {
  const by = (method: string, evaluations: number) => ({ position: 2, method, evaluations })
  const worst = finding('F1', { methods: ['direct', 'cma_es'], found: [by('direct', 90), by('cma_es', 40)] })
  expect(finderOf({ run: run({ worst_method: 'direct' }) }, worst)).toBe('direct')
  expect(finderOf({ run: run({ worst_method: 'genetic' }) }, worst)).toBe('cma_es')
  expect(finderOf({ run: run({ worst_method: 'genetic' }) }, finding('F1'))).toBeNull() // reached only by refinement
  expect(finderOf({ run: run({ worst_method: 'genetic' }) }, finding('F2'))).toBeNull()
  const validation = { realisation: 7 } as unknown as ReturnType<typeof finding>['validation']
  expect(finderOf({ run: run({ worst_method: 'genetic' }) }, finding('F1', { validation }))).toBeNull()
})

it('states a rate only for a time that was measured', () => {
  expect(rateOf(progress({ evaluations: 500, seconds: 0.25 }))).toBe(2000)
  expect([rateOf(progress({ evaluations: 500, seconds: 0 })), rateOf(progress({ evaluations: 0, seconds: 9 }))]).toEqual([null, null])
})

it('speaks of a flight only of a vehicle that moves in space', () => {
  const campaign = { scenario: { vehicle: { component: 'v' } } } as unknown as Campaign
  const inSpace = { ...CATALOGUE, components: [{ ...CATALOGUE.components[0], dimension: 3 }] } as unknown as Catalogue
  expect(leavesGround({ campaign, catalogue: CATALOGUE, nominalTrace: undefined })).toBe(false)
  expect(leavesGround({ campaign, catalogue: inSpace, nominalTrace: undefined })).toBe(true)
  expect(leavesGround({ campaign, catalogue: undefined, nominalTrace: flight({ meta: head({ frame: 'ned' }) }) })).toBe(true)
  expect(leavesGround({ campaign: { simulator: { name: 's' } } as Campaign, catalogue: inSpace, nominalTrace: undefined })).toBe(false)
})

it('the lowest value is that of every stage that asks the question of the campaign', () => {
  const series = (position: number, method: string | null, cost: (number | null)[]) =>
    ({ position, method, cost, parameters: { 'vehicle.m': cost.map((_, k) => k) }, further: {} })
  const stages = [series(0, null, [0.9]), series(1, null, [0.1]), series(2, 'direct', [0.8, null]), series(3, null, [0.7, 0.2])]
  const working = (['nominal', 'baseline', 'search', 'certify'] as const).map((kind, position) => ({ ...progress({ position, own: kind !== 'baseline' }), kind, best: [0.9, 0.1, 0.8, 0.2][position] ?? null }))
  const evaluations = { stages } as unknown as Evaluations
  expect(bestOf({ evaluations, run: run({ worst_cost: 0.2, stages: working }) })).toMatchObject({ cost: 0.2, method: null, parameters: { 'vehicle.m': 1 } })
  expect(bestOf({ evaluations, run: run({ worst_cost: 0.7, stages: working }) })?.cost).toBe(0.2) // read before the evaluations
  expect(leaderOf(run({ worst_cost: 0.2, stages: working }))?.kind).toBe('certify')
})

it('no query of a run shows what belongs to another finding or run', () => {
  const sources = import.meta.glob('../**/*.{ts,tsx}', { query: '?raw', import: 'default', eager: true })
  const found = Object.entries(sources).filter(([name, text]) => !name.includes('.test.') && /placeholderData|keepPreviousData/.test(String(text)))
  expect(found.map(([name]) => name)).toEqual([])
})
