// Shaded ranges and drawn flights of the preview.
import { expect, it } from 'vitest'
import type { Campaign, Uncertain } from '../../api/campaign'
import type { Catalogue, Preview } from '../../client'
import { flownOf } from './flown'
import { planOf } from '../plan/plan'
import { hasHeights } from './PreviewSide'
import { rangesOf } from './ranges'

const parameter = (name: string) => ({ name, symbol: name, unit: '', low: -1e6, high: 1e6, default: 0, text: '' })
const sphere = ['position.x', 'position.y', 'position.z', 'speed', 'heading', 'climb', 'radius']
const start = ['x', 'y', 'z', 'psi'].map(parameter)
const CATALOGUE = {
  version: '',
  methods: [],
  components: [
    { role: 'vehicle', name: 'aircraft', dimension: 3, frame: 'ned', parameters: [], starts: start },
    { role: 'obstacle', name: 'sphere', dimension: 3, moving: true, parameters: sphere.map(parameter) },
  ],
} as unknown as Catalogue

function campaign(uncertain: Record<string, Uncertain>): Campaign {
  const parameters = { 'position.x': 100, 'position.y': 800, 'position.z': -50, speed: 20, heading: 0, radius: 10 }
  const part = { component: 'any' }
  return {
    name: 'Case',
    scenario: {
      vehicle: { component: 'aircraft' }, controller: part, avoider: part, start: { psi: 0.5 }, goal: { x: 400, y: 0 },
      obstacles: [{ component: 'sphere', parameters }], horizon: 10, step: 1,
    },
    uncertain,
    criterion: { component: 'separation', threshold: 50 },
    stages: { search: [] },
  }
}

it('shades places by their bounds, north up, shares worked out', () => {
  const bounded = campaign({
    'obstacles.0.position.x': { low: 90, high: 120 },
    'obstacles.0.position.z': { low: -60, high: -40 },
    'obstacles.0.radius': { plus_minus: '20%' },
    'start.psi': { low: 0, high: 0.5 },
    'vehicle.m': { low: 1, high: 2 },
  })
  const { boxes, fans, rings } = rangesOf(bounded, CATALOGUE, planOf(bounded, CATALOGUE))
  expect(boxes).toHaveLength(1)
  expect(boxes[0]?.low).toMatchObject({ x: 800, y: 90, up: 60 })
  expect(boxes[0]?.high).toMatchObject({ x: 800, y: 120, up: 40 })
  expect(rings).toMatchObject([{ low: 8, high: 12, at: { x: 800, y: 100 } }])
  expect(fans[0]?.from).toBeCloseTo(Math.PI / 2 - 0.5, 12)
  expect(fans[0]?.to).toBeCloseTo(Math.PI / 2, 12)
})

it('shades nothing while a bound is half typed or turned round', () => {
  const bounded = campaign({ 'start.x': { low: 3, high: 1 }, 'start.y': { low: '3 m', high: 4 } })
  expect(rangesOf(bounded, CATALOGUE, planOf(bounded, CATALOGUE)).boxes).toEqual([])
})

it('draws a flight up to where it is known, heights upwards', () => {
  const preview = {
    frame: 'ned', t: [0, 1, 2], x: [0, 20, null], y: [0, 5, null], z: [0, -3, null],
    intruders: [{ obstacle: 0, x: [100, 100, 100], y: [800, 780, 760], z: [0, 0, 0] }],
    closest: { time: 1.5, value: 60, position: [20, 5, -3], obstacle: 0, obstacle_position: [100, 780, 0] },
  } as unknown as Preview
  const flown = flownOf(preview)
  expect(flown.path).toEqual([{ x: 0, y: 0, up: 0, t: 0 }, { x: 5, y: 20, up: 3, t: 1 }])
  expect(flown.intruders.get(0)).toHaveLength(3)
  expect(flown.closest).toMatchObject({ at: { x: 5, y: 20, up: 3 }, other: { x: 780, y: 100 }, time: 1.5 })
})

it('shows heights only where there are two', () => {
  const ranges = { boxes: [], fans: [], rings: [] }
  const plan = planOf(campaign({}), CATALOGUE)
  expect(hasHeights({ plan, ranges, flown: null })).toBe(true)
  const level = { ...plan, bodies: [] }
  expect(hasHeights({ plan: level, ranges, flown: null })).toBe(false)
  expect(hasHeights({ plan: { ...plan, space: false }, ranges, flown: null })).toBe(false)
})
