// Ranges on axes, thinning, and contrast of colours in both themes.
import { expect, it } from 'vitest'
import type { Evaluations, EvaluationSeries } from '../../client'
import { againOf } from './again'
import { rgbOf, SHADES, shadeOf } from './colours'
import { DASHED, dashOf, layersOf } from './paint'
import {
  type Axis,
  brushed,
  brushOf,
  brushTexts,
  evaluationOf,
  keptOf,
  nudged,
  rangeOn,
  spaceOf,
  thinned,
  VALUE,
  valueAt,
  valueAxis,
  criterionAxis,
  parametersAt,
  parametersOf,
  rankedFrom,
  worstOf,
} from './space'

const axis = (key: string, low = 0, high = 10): Axis => ({ key, symbol: key, unit: '', text: '', low, high })
const AXES = [axis(VALUE), axis('a'), axis('b')]

function series(position: number, cost: (number | null)[], a: number[], status?: string[]): EvaluationSeries {
  return {
    position,
    kind: 'search',
    method: `m${position}`,
    total: 100,
    stored: 100,
    index: cost.map((_, i) => 10 * i),
    cost,
    status: status ?? cost.map(() => 'ok'),
    parameters: { a, b: a.map((v) => 10 - v) },
    seeds: [],
  } as unknown as EvaluationSeries
}

const made = (stages: EvaluationSeries[], most = 100) =>
  spaceOf({ evaluations: { criteria: [], stages, failures: [] }, axes: AXES, titleOf: (s) => s.method ?? '', most })

const TWO = made([
  series(2, [3, 1, null, null], [1, 2, 3, 4], ['ok', 'ok', 'timeout', 'excluded']),
  series(3, [2, 5], [8, 9]),
])
const NONE = new Set<string>()
const kept = (brush: object, hidden: ReadonlySet<string> = NONE) => [...keptOf(TWO, brush as never, hidden)]

it('puts all stages into columns', () => {
  expect(TWO.count).toBe(6)
  expect(TWO.total).toBe(200)
  expect([...(TWO.columns[1] ?? [])]).toEqual([1, 2, 3, 4, 8, 9])
  expect([...TWO.fates]).toEqual([0, 0, 1, 2, 0, 0])
  expect([...TWO.of]).toEqual([0, 0, 0, 0, 1, 1])
  expect(TWO.groups.map(({ shown }) => shown)).toEqual([4, 2])
})

it('has further criteria between the value and the parameters', () => {
  const judged = { ...series(2, [3, 1, null], [1, 2, 3], ['ok', 'ok', 'failed']), further: { miss: [7, 9, null] } }
  const criterion = { name: 'miss', component: 'miss', title: 'Miss', quantity: 'd', unit: 'm', worse: 'high', measured_to: '' } as const
  const further = criterionAxis({ criteria: [criterion], stages: [judged], failures: [] }, criterion)
  expect([further.key, further.worse, further.low < 7, further.high > 9]).toEqual(['miss', 'high', true, true])
  const axes = [axis(VALUE), further, axis('a')]
  const space = spaceOf({ evaluations: { criteria: [], stages: [judged], failures: [] }, axes, titleOf: () => '', most: 10 })
  expect([...(space.columns[1] ?? [])]).toEqual([7, 9, Number.NaN])
  expect(parametersOf(axes)).toEqual([2])
  const ink = { theme: 'light', low: 7, high: 9, axis: 1, turned: true } as const
  // The worst ones are in the first layer, which is painted last.
  expect(layersOf(space, Uint32Array.of(0, 1, 2), ink).shaded[0]).toEqual([1])
})

it('leaves out a stage without the parameters', () => {
  const bare = { ...series(4, [1], [1]), parameters: {} }
  expect(made([bare]).count).toBe(0)
})

it('keeps what lies within every range, bounds included', () => {
  expect(kept({})).toEqual([0, 1, 2, 3, 4, 5])
  expect(kept({ a: [2, 8] })).toEqual([1, 2, 3, 4])
  expect(kept({ a: [2, 8], b: [0, 7] })).toEqual([2, 3, 4])
  expect(kept({ a: [4.1, 7.9] })).toEqual([])
})

it('keeps nothing without a value in a range of values', () => {
  expect(kept({ [VALUE]: [0, 10] })).toEqual([0, 1, 4, 5])
})

it('leaves out stages and fates that are switched off', () => {
  expect(kept({}, new Set(['2']))).toEqual([4, 5])
  expect(kept({}, new Set(['failed', '3']))).toEqual([0, 1, 3])
})

it('finds the lowest of the filtered evaluations', () => {
  expect(worstOf(TWO, keptOf(TWO, {}, NONE))).toBe(1)
  expect(worstOf(TWO, keptOf(TWO, { a: [8, 9] }, NONE))).toBe(4)
  expect(worstOf(TWO, keptOf(TWO, { a: [3, 4] }, NONE))).toBeNull()
})

it('finds the evaluation that a what-if repeats, by all of its parameters and its noise', () => {
  const seeded = { ...series(2, [3, 1, 2], [1, 1, 0.1 + 0.2]), seeds: [7, null, null] }
  const space = made([seeded])
  const all = keptOf(space, {}, NONE)
  expect(parametersAt(space, 2)).toEqual({ a: 0.1 + 0.2, b: 10 - (0.1 + 0.2) })
  expect(evaluationOf(space, all, parametersAt(space, 2), null)).toBe(2)
  expect(evaluationOf(space, all, { a: 1, b: 9 }, 7)).toBe(0)
  expect(evaluationOf(space, all, { a: 1, b: 9 }, null)).toBe(1)
  expect(evaluationOf(space, all, { a: 0.3, b: 9.7 }, null)).toBeNull()
  expect(evaluationOf(space, all, { a: 1 }, null)).toBeNull()
  expect(evaluationOf(space, Uint32Array.of(0, 1), parametersAt(space, 2), null)).toBeNull()
})

it('goes from value to value, those without one last', () => {
  const all = keptOf(TWO, {}, NONE)
  const walked = [1]
  while (walked.length < 7) walked.push(rankedFrom(TWO, all, walked.at(-1) as number, 1))
  expect(walked).toEqual([1, 4, 0, 5, 2, 3, 3])
  expect(rankedFrom(TWO, all, 1, -1)).toBe(1)
  expect(rankedFrom(TWO, Uint32Array.of(1, 5), 1, 1)).toBe(5)
})

it('compares a simulation with the stored evaluation by every bit', () => {
  const stored = { cost: 0.75, fate: 'ok' } as const
  const lost = { cost: Number.NaN, fate: 'failed' } as const
  expect(againOf({ cost: 0.75, status: 'ok', reason: '', code_changes: [] }, stored)).toBe('identical to the stored value')
  expect(againOf({ cost: 0.75 + 2 ** -53, status: 'ok', reason: '', code_changes: [] }, stored)).toBe('differs from the stored value by 1.11e-16')
  expect(againOf({ cost: 0.7, status: 'ok', reason: '', code_changes: ['components/my_way.py'] }, stored)).toContain('(other code than the run: components/my_way.py)')
  expect(againOf({ cost: null, status: 'failed', reason: 'It fell.', code_changes: [] }, stored)).toBe('failed: It fell, unlike the stored evaluation')
  expect(againOf({ cost: null, status: 'failed', reason: 'It fell.', code_changes: [] }, lost)).toBe('failed: It fell, as stored')
  expect(againOf({ cost: null, status: 'timeout', reason: '', code_changes: [] }, lost)).toBe('timeout, as stored')
  expect(againOf({ cost: null, status: 'excluded', reason: '', code_changes: [] }, lost)).toBe('excluded, unlike the stored evaluation')
  expect(againOf({ cost: 0.7, status: 'ok', reason: '', code_changes: [] }, lost)).toBe('ok, unlike the stored evaluation')
})

it('thins evenly and keeps the lowest', () => {
  const costs = Array.from({ length: 1000 }, (_, i) => (i === 777 ? -1 : i))
  const rows = thinned(costs, 50)
  expect(rows.length).toBeLessThanOrEqual(50)
  expect(rows.length).toBeGreaterThan(45)
  expect(rows).toContain(777)
  expect([rows[0], rows[rows.length - 1]]).toEqual([0, 999])
  expect(thinned([null, null, null], 2).length).toBeLessThanOrEqual(2)
  const many = Array.from({ length: 10 }, (_, i) => series(i, costs, costs))
  expect(made(many, 500).count).toBeLessThanOrEqual(500)
})

it('takes a range either way round, cut to the axis, and no range for the whole axis', () => {
  expect(rangeOn(axis('a'), 7, -3)).toEqual([0, 7])
  expect(rangeOn(axis('a'), 12, -3)).toBeNull()
  const one = brushed({}, axis('a'), [1, 2])
  expect(brushed(one, axis('b'), [3, 4])).toEqual({ a: [1, 2], b: [3, 4] })
  expect(brushed(one, axis('a'), null)).toEqual({})
  expect(brushed(one, axis('b'), null)).toBe(one)
})

it('rounds the ends of a range, except at the bounds of the axis', () => {
  expect(rangeOn(axis('a', 0.0333, 10.0333), 0, 7.123456)).toEqual([0.0333, 7.12])
  expect(rangeOn(axis('a', 0, 1e-5), 2.34567e-6, 1)).toEqual([2.35e-6, 1e-5])
})

it('stands in the address, and is read from it where it means something', () => {
  const brush = { 'vehicle.m': [-1.5, 2], a: [1, 1] } as const
  const axes = [axis('vehicle.m', -2, 4), axis('a')]
  expect(brushTexts(brush)).toEqual(['vehicle.m:-1.5:2', 'a:1:1'])
  expect(brushOf(brushTexts(brush), axes)).toEqual(brush)
  expect(brushOf(['a', 'a:1', 'a::', 'a:x:2', 'a:3:2', 'a:11:12', 'c:1:2', ''], axes)).toEqual({})
})

it('moves the ends of a range by keys without crossing them', () => {
  expect(nudged(axis('a'), [2, 3], 0, 'ArrowUp')).toEqual([2.1, 3])
  expect(nudged(axis('a'), [2, 3], 0, 'End')).toEqual([3, 3])
  expect(nudged(axis('a'), [2, 3], 1, 'Home')).toEqual([2, 2])
  expect(nudged(axis('a'), [2, 3], 1, 'PageUp')).toEqual([2, 4])
  expect(nudged(axis('a'), [2, 3], 1, 'Tab')).toBeNull()
})

it('reads values back from a place on the axis', () => {
  expect(valueAt(axis('a', 4, 6), 0.25)).toBe(4.5)
  expect(valueAt(axis('a', 4, 6), 1.2)).toBe(6)
})

it('has the criterion on the axis of values where it is near', () => {
  const found: Evaluations = { criteria: [], stages: [series(2, [2, 3, null], [1, 2, 3])], failures: [] }
  expect(valueAxis(found, 'd', 'm', 1.5).low).toBeLessThan(1.5)
  expect(valueAxis(found, 'd', 'm', -50).low).toBeGreaterThan(1.9)
  expect(valueAxis({ criteria: [], stages: [], failures: [] }, 'd', 'm', null).high).toBeGreaterThan(0)
})

const GROUND = { light: [255, 255, 255], dark: [20, 25, 31] } as const

/** WCAG 2.2, relative luminance. */
function luminance(rgb: readonly number[]): number {
  const [r, g, b] = rgb.map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4))
  return 0.2126 * (r ?? 0) + 0.7152 * (g ?? 0) + 0.0722 * (b ?? 0)
}

it.each(['light', 'dark'] as const)('colours stand out and fade evenly towards the ground, %s', (theme) => {
  const ground = luminance(GROUND[theme])
  const contrast = Array.from({ length: 50 }, (_, i) => luminance(rgbOf(i / 49, theme))).map(
    (mark) => (Math.max(mark, ground) + 0.05) / (Math.min(mark, ground) + 0.05),
  )
  expect(Math.min(...contrast)).toBeGreaterThanOrEqual(3)
  for (let i = 1; i < contrast.length; i++) expect(contrast[i]).toBeLessThan(contrast[i - 1] ?? 0)
})

it('gives lower values lower shades', () => {
  expect([0, 5, 10, 11].map((v) => shadeOf(v, 0, 10))).toEqual([0, SHADES / 2, SHADES - 1, SHADES - 1])
  expect(shadeOf(3, 3, 3)).toBe(0)
})

it('dashes few lines only: thousands of them stop the page for 20 s without a graphics card', () => {
  expect(dashOf(DASHED, [4, 3])).toEqual([4, 3])
  expect(dashOf(DASHED + 1, [4, 3])).toEqual([])
})
