// Drawn paths of moving obstacles agree with the worker's components, for all axes of the vehicle.
import { beforeAll, expect, it } from 'vitest'
import type { Campaign } from '../../api/campaign'
import type { Catalogue } from '../../client'
import { axesOf, planOf } from './plan'
import { python, shipped } from '../../../tests/repository'
import { at, courseOf, liftOf } from './ways'

const TIMES = [0, 1, 2.5, 4]

const FLY = `
import json, sys
from tests.physics.test_obstacles import OBSTACLES, made
from worker.engine.kernels.component import declared
request = json.load(sys.stdin)
found = {}
for o in OBSTACLES:
    if not o.moving or o.states:
        continue
    fields = {p.name: p.field for p in declared(o.parameters)}
    parameters = {k: v for k, v in request["values"].items() if k in fields}
    body = made(o.name, **{fields[k]: v for k, v in parameters.items()})
    seen = [body(t, (0.0,) * o.dimension) for t in request["times"]]
    found[o.name] = {"parameters": parameters, "dimension": o.dimension, "at": [[b.x, b.y, getattr(b, "z", 0.0)] for b in seen]}
print(json.dumps(found))
`

const VALUES = {
  'position.x': 10, 'position.y': -20, 'position.z': 5, 'goal.x': 40, 'goal.y': 30, 'goal.z': 25,
  'centre.x': 3, 'centre.y': 4, 'centre.z': -6, way: 200, phase: 0.4,
  'waypoint1.x': 30, 'waypoint1.y': 0, 'waypoint1.z': 15, 'waypoint2.x': 60, 'waypoint2.y': 0, 'waypoint2.z': 15, legs: 2,
  speed: 6, heading: 0.7, climb: 0.4,
} // prettier-ignore

interface Flown {
  parameters: Record<string, number>
  dimension: number
  at: [number, number, number][]
}

let catalogue: Catalogue
let flown: Record<string, Flown>

beforeAll(() => {
  catalogue = shipped().catalogue
  flown = python(FLY, JSON.stringify({ values: VALUES, times: TIMES }))
})

it.each(['enu', 'ned'] as const)('is drawn as it flies under a vehicle with axes %s', (frame) => {
  const vehicle = { ...catalogue.components[0], role: 'vehicle', name: 'vehicle', frame } as Catalogue['components'][number]
  const installed = { ...catalogue, components: [vehicle, ...catalogue.components] }
  const axes = axesOf(frame === 'ned')
  expect(Object.keys(flown).length).toBeGreaterThanOrEqual(6)
  for (const [name, { parameters, at: places }] of Object.entries(flown)) {
    const part = { component: 'any' }
    const obstacles = [{ component: name, parameters }]
    const scenario = { vehicle: { component: 'vehicle' }, controller: part, avoider: part, goal: { x: 1, y: 1 }, obstacles, horizon: 5, step: 1 }
    const campaign: Campaign = { name, scenario, uncertain: {}, criterion: { component: 'any', threshold: 1 }, stages: { search: [] } }
    const track = planOf(campaign, installed).bodies[0]?.track ?? []
    for (const [i, [x, y, z]] of places.entries()) {
      const drawn = at(track, TIMES[i] as number)
      const there = axes.map({ x, y, up: frame === 'ned' ? -z : z, t: 0 })
      // A round is drawn as chords.
      for (const key of ['x', 'y', 'up'] as const) expect(drawn?.[key], `${name} ${key}`).toBeCloseTo(there[key], 2)
    }
  }
})

it('omits a climb of unknown direction', () => {
  const values = { speed: 10, heading: 0, climb: 0.5 }
  const from = { x: 0, y: 0, up: 7, t: 0 }
  const up = (writtenIn: string | undefined, ned: boolean) =>
    courseOf((name) => values[name as keyof typeof values] ?? null, from, 1, liftOf(writtenIn, ned))?.up
  expect(up('', false)).toBe(7)
  expect(up(undefined, true)).toBeCloseTo(7 + 10 * Math.sin(0.5))
  expect(up('enu', false)).toBeCloseTo(7 + 10 * Math.sin(0.5))
  expect(up('ned', false)).toBeCloseTo(7 - 10 * Math.sin(0.5))
  expect(up('enu', true)).toBeCloseTo(7 - 10 * Math.sin(0.5))
})
