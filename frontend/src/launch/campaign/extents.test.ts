// Thresholds of centre distances that are smaller than an obstacle.
import { expect, it } from 'vitest'
import type { Campaign, Part } from '../../api/campaign'
import type { Catalogue, ComponentEntry } from '../../client'
import { criterionFor, withinOf } from './extents'

const parameter = (name: string, fallback: number) => ({ name, symbol: name, unit: 'm', low: 0, high: 1e6, default: fallback, text: '' })
const component = (role: ComponentEntry['role'], name: string, more: Partial<ComponentEntry>): ComponentEntry =>
  ({ role, name, title: name, dimension: 2, parameters: [], text: '', ...more }) as ComponentEntry

const CATALOGUE = {
  version: '',
  methods: [],
  components: [
    component('obstacle', 'circle', { parameters: [parameter('radius', 0.5)], reach: { of: ['radius'], times: 1 } }),
    component('obstacle', 'box', {
      parameters: [parameter('length', 16), parameter('width', 0.2)],
      reach: { of: ['length', 'width'], times: 0.5 },
    }),
    component('obstacle', 'other', {}),
    component('criterion', 'separation', { measured_to: 'centre', unit: 'm' }),
    component('criterion', 'separation_mm', { measured_to: 'centre', unit: 'mm' }),
    component('criterion', 'surface_separation', { measured_to: 'surface' }),
  ],
} as Catalogue

const part = (name: string, parameters = {}): Part => ({ component: name, parameters })
const campaignOf = (threshold: number, obstacles: Part[], more = {}): Campaign => ({
  name: 'Case',
  scenario: { vehicle: part('any'), controller: part('any'), avoider: part('any'), goal: {}, obstacles, horizon: 1, step: 1 },
  uncertain: {},
  criterion: { component: 'separation', threshold, ...more },
  stages: { search: [] },
})

it('finds the obstacles that reach beyond the threshold', () => {
  expect(withinOf(campaignOf(0.5, [part('circle'), part('box'), part('other')]), CATALOGUE)).toEqual(new Map([[1, 0.5 * Math.hypot(16, 0.2)]]))
  expect(withinOf(campaignOf(8.001, [part('box')]), CATALOGUE).size).toBe(0)
})

it('counts the largest extent of an uncertain one', () => {
  const campaign = { ...campaignOf(0.55, [part('circle')]), uncertain: { 'obstacles.0.radius': { plus_minus: '20%' } } }
  expect(withinOf(campaign, CATALOGUE).get(0)).toBeCloseTo(0.6)
})

it('leaves alone what is stated, and what measures to surfaces or in another unit', () => {
  expect(withinOf(campaignOf(0.1, [part('box')], { from_centre: true }), CATALOGUE).size).toBe(0)
  expect(withinOf(campaignOf(0.1, [part('box')], { component: 'surface_separation' }), CATALOGUE).size).toBe(0)
  expect(withinOf(campaignOf(0.1, [part('box')], { component: 'separation_mm' }), CATALOGUE).size).toBe(0)
})

it('judges by surfaces once an obstacle reaches beyond the threshold', () => {
  const campaign = campaignOf(0.5, [part('circle')])
  expect(criterionFor(campaign, [part('circle')], CATALOGUE)).toEqual(campaign.criterion)
  expect(criterionFor(campaign, [part('circle'), part('box')], CATALOGUE)).toEqual({
    component: 'surface_separation',
    parameters: {},
    threshold: 0.5,
  })
})

it('keeps the requirements of a criterion', () => {
  const campaign = campaignOf(0.5, [part('circle')], { requirements: ['REQ-1', { id: 'REQ-2', text: 'x' }] })
  expect(criterionFor(campaign, [part('box')], CATALOGUE).requirements).toEqual(['REQ-1', { id: 'REQ-2', text: 'x' }])
})
