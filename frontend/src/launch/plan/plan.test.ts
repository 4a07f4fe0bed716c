// What a library card draws of a scenario.
import { describe, expect, it } from 'vitest'
import type { Campaign, Part } from '../../api/campaign'
import type { Catalogue, ComponentEntry, ObstacleLook } from '../../client'
import { extentOf, fit, planOf } from './plan'
import { at } from './ways'

const parameter = (name: string, fallback: number | null = null) => ({
  name,
  symbol: name,
  unit: '',
  low: -1e6,
  high: 1e6,
  default: fallback,
  text: '',
})

const component = (role: ComponentEntry['role'], name: string, more: Partial<ComponentEntry> = {}): ComponentEntry =>
  ({ role, name, title: name, dimension: 2, parameters: [], text: '', ...more }) as ComponentEntry

const CATALOGUE = {
  version: '',
  methods: [],
  components: [
    component('vehicle', 'robot'),
    component('vehicle', 'aircraft', { frame: 'ned' }),
    component('obstacle', 'circle', { parameters: [parameter('radius', 0.5)] }),
    component('obstacle', 'moving_circle', {
      moving: true,
      parameters: ['position.x', 'position.y', 'goal.x', 'goal.y', 'speed'].map((name) => parameter(name, 1)),
    }),
    component('obstacle', 'pillar', {
      look: { shape: 'rectangle', radius: '', height: 'rise', sides: ['long', 'wide'], angle: 'turn', way: 'velocity' } satisfies ObstacleLook,
    }),
    component('vehicle', 'sled', { look: { mesh: 'robot', heading: 'yaw' } }),
  ],
} as Catalogue

function campaign(vehicle: string, obstacles: Part[], goal: Record<string, number>, start = {}): Campaign {
  const part = { component: 'any' }
  return {
    name: 'Case',
    scenario: { vehicle: { component: vehicle }, controller: part, avoider: part, start, goal, obstacles, horizon: 10, step: 1 },
    uncertain: {},
    criterion: { component: 'separation', threshold: 2 },
    stages: { search: [] },
  }
}

const obstacle = (parameters: Record<string, number>, component = 'any'): Part => ({ component, parameters })
const one = (part: Part, vehicle = 'robot') => {
  const plan = planOf(campaign(vehicle, [part], { x: 6, y: 7 }), CATALOGUE)
  return plan.bodies[0] as (typeof plan.bodies)[number]
}

describe('a plan of robots', () => {
  it('has start, heading, goal and a disc with its default radius', () => {
    const disc = obstacle({ 'position.x': 4, 'position.y': 3 }, 'circle')
    const plan = planOf(campaign('robot', [disc], { x: 6, y: 7 }, { x: 1, y: 2, theta: 0.5 }), CATALOGUE)
    expect(plan.start).toEqual({ x: 1, y: 2, up: 0, t: 0 })
    expect(plan.heading).toBe(0.5)
    expect(plan.goal).toMatchObject({ x: 6, y: 7 })
    expect(plan.way).toMatchObject([{ x: 1, y: 2 }, { x: 6, y: 7 }])
    expect(plan.bodies[0]).toMatchObject({ radius: 0.5, rectangle: null, height: null, at: { x: 4, y: 3 }, track: [] })
  })
  it('takes an intruder as far as it comes, and not beyond its goal', () => {
    const way = { 'position.x': 0, 'position.y': 0, 'goal.x': 30, 'goal.y': 40 }
    expect(one(obstacle({ ...way, speed: 1 })).track).toMatchObject([{ x: 0, y: 0, t: 0 }, { x: 6, y: 8, t: 10 }])
    expect(one(obstacle({ ...way, speed: 9 })).track).toMatchObject([{ x: 0, y: 0 }, { x: 30, y: 40 }])
  })
  it('includes only the waypoints that are used', () => {
    const way = { 'position.x': 0, 'position.y': 0, 'waypoint1.x': 4, 'waypoint1.y': 0, 'waypoint2.x': 4, 'waypoint2.y': 4 }
    expect(one(obstacle({ ...way, legs: 1, speed: 9 })).track).toHaveLength(2)
    expect(one(obstacle({ ...way, legs: 2, speed: 0.5 })).track).toMatchObject([{ x: 0, y: 0 }, { x: 4, y: 0 }, { x: 4, y: 1, t: 10 }])
  })
  it('goes round from its phase, anticlockwise', () => {
    const { at, track } = one(obstacle({ 'centre.x': 1, 'centre.y': 1, way: 5, phase: 0, speed: Math.PI / 4 }))
    expect(at).toMatchObject({ x: 6, y: 1 })
    expect(track.at(-1)?.x).toBeCloseTo(1, 9)
    expect(track.at(-1)?.y).toBeCloseTo(6, 9)
  })
  it('draws by the look that an obstacle declares, whatever its parameters are called', () => {
    const place = { 'position.x': 1, 'position.y': 1, 'velocity.x': 2, 'velocity.y': 0, 'goal.x': 9, 'goal.y': 9 }
    const body = one(obstacle({ ...place, long: 4, wide: 2, turn: 0.3, rise: 5, radius: 7, speed: 1, length: 8 }, 'pillar'))
    expect(body).toMatchObject({ radius: 0, rectangle: { length: 4, width: 2, angle: 0.3 }, height: 5 })
    expect(body.track).toMatchObject([{ x: 1, y: 1 }, { x: 21, y: 1, t: 10 }])
    expect(planOf(campaign('sled', [], { x: 6, y: 7 }, { yaw: 0.4, theta: 1 }), CATALOGUE).heading).toBe(0.4)
  })
  it('turns a box', () => {
    const body = one(obstacle({ 'position.x': 1, 'position.y': 1, length: 4, width: 2, angle: 0.3 }))
    expect(body.rectangle).toEqual({ length: 4, width: 2, angle: 0.3 })
    expect(body.track).toEqual([])
  })
})

describe('a plan of aircraft', () => {
  const sphere = obstacle({ 'position.x': 0, 'position.y': 800, speed: 20, heading: -Math.PI / 2, climb: 0 })
  it('has north up and east to the right', () => {
    const plan = planOf(campaign('aircraft', [sphere], { x: 500, y: 100 }, { x: 10, y: 20, psi: 0.9 }), CATALOGUE)
    expect(plan.start).toMatchObject({ x: 20, y: 10 })
    expect(plan.goal).toMatchObject({ x: 100, y: 500 })
    expect(plan.heading).toBeCloseTo(Math.PI / 2 - 0.9, 12)
    const [from, to] = plan.bodies[0]?.track ?? []
    expect(from).toMatchObject({ x: 800, y: 0 })
    expect(to?.x).toBeCloseTo(600, 9) // westwards
    expect(to?.y).toBeCloseTo(0, 9)
  })
  it('has a course where there is no goal', () => {
    const plan = planOf(campaign('aircraft', [sphere], { speed: 20, heading: 0, climb: 0 }), CATALOGUE)
    expect(plan.goal).toBeNull()
    expect(plan.way).toMatchObject([{ x: 0, y: 0 }, { x: 0, y: 200 }])
  })
})

describe('heights', () => {
  it('go up where z points down, and with a climb', () => {
    const sphere = { 'position.x': 0, 'position.y': 0, 'position.z': -100, speed: 10, heading: 0, climb: 0.5 }
    const { track } = one(obstacle(sphere), 'aircraft')
    expect(track[0]?.up).toBe(100)
    expect(track.at(-1)?.up).toBeCloseTo(100 + 100 * Math.sin(0.5), 9)
    expect(at(track, 5)?.up).toBeCloseTo(100 + 50 * Math.sin(0.5), 9)
    expect(at(track, 11)).toBeNull()
  })
  it('count in how far waypoints are apart', () => {
    const way = { 'position.x': 0, 'position.y': 0, 'position.z': 0, 'waypoint1.x': 3, 'waypoint1.y': 0, 'waypoint1.z': 4 }
    expect(one(obstacle({ ...way, legs: 1, speed: 0.25 })).track.at(-1)).toMatchObject({ x: 1.5, up: 2, t: 10 })
  })
})

it('draws what a campaign states where its components are unknown', () => {
  const plan = planOf(campaign('robot', [obstacle({ 'position.x': 4, 'position.y': -3, radius: 1 })], { x: -6, y: 7 }), undefined)
  expect(plan.bodies[0]).toMatchObject({ at: { x: 4, y: -3 }, radius: 1 })
  expect(plan.goal).toMatchObject({ x: -6, y: 7 })
})

it('fits everything into the picture, the safety radius among it', () => {
  const plan = planOf(campaign('robot', [obstacle({ 'position.x': -40, 'position.y': 3, radius: 1 })], { x: 6, y: 7 }), undefined)
  const points = extentOf(plan, 20)
  const view = fit(points, 280, 140, { x: 24, y: 18 })
  for (const p of points) {
    expect(view.x(p)).toBeGreaterThanOrEqual(23.999)
    expect(view.x(p)).toBeLessThanOrEqual(256.001)
    expect(view.y(p)).toBeGreaterThanOrEqual(17.999)
    expect(view.y(p)).toBeLessThanOrEqual(122.001)
  }
  expect(view.y({ x: 0, y: 5 })).toBeLessThan(view.y({ x: 0, y: 0 }))
  expect(fit([{ x: 3, y: 3 }], 280, 140, { x: 24, y: 18 }).x({ x: 3, y: 3 })).toBe(140)
})
