// Labels of parameters.
import { expect, it } from 'vitest'
import type { Campaign } from '../../api/campaign'
import type { Catalogue } from '../../client'
import { uncertainOf } from './data'

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

it('calls parameters of one symbol by their paths', () => {
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
    'vehicle.r: r',
    'obstacles.0.r: r',
    'obstacles.0.speed: speed',
    'obstacles.1.speed: speed',
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
