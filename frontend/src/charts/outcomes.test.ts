// Charts of outcomes: a run that is not done has no number and is marked at its position.
import { expect, it } from 'vitest'
import type { Outcome } from '../client'
import { type At, boundName, boundsOf, commonOf, fractionOf, kindsOf, marginsOf, observedName, sampleOf, spoken } from './outcomes'
import { valueText } from './spec'

const outcome = (more: Partial<Outcome> = {}): Outcome => ({
  id: 'R-0001', name: '', state: 'done', verdict: 'cleared', error: null, campaign_name: '', campaign_digest: '', seed: 1,
  code: 'a', unidentified: [], clearance: null, quantity: 'd_min', unit: 'm', threshold: 0.5, worst_cost: 0.8, margin: 0.3, upper_bound: 0.001,
  bound_source: 'certify', excluded_samples: 0, excluded_fraction: 0,
  violations: 0, failed_samples: 0, samples: 3000, confidence: 0.95, created: 0, finished: 1, removed: false, not_sampled: false, earlier_rules: false, against: '', policy: null, unconfirmed: '', ...more,
})
const bare = { margin: null, worst_cost: null, upper_bound: null, bound_source: null, violations: null, failed_samples: null, samples: null, confidence: null } as const
const points: At[] = [
  { x: 1, run: 'R-0001', outcome: outcome() },
  { x: 2, run: 'R-0002', outcome: outcome({ verdict: 'violated', margin: -0.1, violations: 3, upper_bound: 0.01 }) },
  { x: 3, run: 'R-0003', outcome: outcome({ state: 'failed', verdict: null, unit: '', quantity: '', ...bare }) },
  { x: 4, run: 'R-0004', outcome: null },
  { x: 6, run: 'R-0005', outcome: outcome({ verdict: 'inconclusive', margin: 0 }) },
]
const axis = { xTitle: 'x', xText: String }

it('draws margins of runs that are done, and marks the others', () => {
  const spec = marginsOf(points, axis, 200, 's')
  expect(spec?.x).toEqual([1, 2, 3, 4, 6])
  expect(spec?.lines[0]?.y).toEqual([0.3, -0.1, null, null, 0])
  expect(spec?.lines[0]?.dots).toBe(true)
  expect(spec?.points?.map(({ x, colour, hollow }) => [x, colour, hollow])).toEqual([
    [1, '--ok-solid', false],
    [2, '--bad-solid', false],
    [6, '--unk-solid', true],
  ])
  expect(spec?.rules?.map(({ x }) => x)).toEqual([3, 4])
  expect(spec?.criterion?.value).toBe(0)
  expect(spec?.xRange).toEqual([0.8, 6.2])
  expect(spec?.yText(-0.1)).toBe('−0.1000 m')
})

it('draws a contradicted run as no success', () => {
  const against = 'R-0002 violates the criterion, on the same question and model.'
  const both: At[] = [{ x: 1, run: 'R-0001', outcome: outcome({ against }) }, { x: 2, run: 'R-0003', outcome: outcome() }]
  expect(marginsOf(both, axis, 200, 's')?.points?.map(({ colour, hollow }) => [colour, hollow])).toEqual([['--unk-solid', true], ['--ok-solid', false]])
  expect(kindsOf(both)).toEqual(['cleared', 'contradicted'])
})

it('draws bounds and observed fractions in percent', () => {
  const spec = boundsOf(points, axis, 200, 's')
  expect(spec?.lines.map((line) => line.y)).toEqual([
    [0.1, 1, null, null, 0.1],
    [0, 0.1, null, null, 0],
  ])
  expect(spec?.yRange?.[0]).toBe(0)
  expect(boundName(points)).toBe('Upper bound, 95\u202f% confidence')
  expect(boundName([{ x: 1, run: '', outcome: outcome({ confidence: 0.9496 }) }])).toBe('Upper bound, 94.96\u202f% confidence')
  expect(boundName([...points, { x: 7, run: '', outcome: outcome({ confidence: 0.99 }) }])).toBe('Upper bound')
})

it('reads a bound out as the table has it, never below itself', () => {
  const at = [1 - 0.05 ** (1 / 3000), 1 - 0.05 ** (1 / 300), 1 - 0.05 ** (1 / 59), 0.07].map((upper_bound, x): At => ({
    x, run: '', outcome: outcome({ upper_bound }),
  }))
  const spec = boundsOf(at, axis, 200, 's')
  const [bound, observed] = spec?.lines ?? []
  const read = at.map((_, k) => spec && bound && valueText(spec, bound, k))
  expect(read).toEqual(['0.0999\u202f%', '0.994\u202f%', '4.96\u202f%', '7\u202f%'])
  expect(spec && observed && valueText(spec, observed, 0)).toBe('0\u202f%')
})

it('names a random search or a stated seed as what a bound rests on, and nothing of an independent sample', () => {
  const at = (['certify', 'search', 'certify_stated'] as const).map((bound_source, x): At => ({ x, run: '', outcome: outcome({ upper_bound: 0.01, bound_source }) }))
  expect(boundsOf(at, axis, 200, 's')?.lines[0]?.texts).toEqual(['1\u202f%', '1\u202f%, random search', '1\u202f%, stated seed'])
})

it('has no chart without a number', () => {
  const none = points.slice(2, 4)
  expect(marginsOf(none, axis, 200, 's')).toBeNull()
  expect(boundsOf(none, axis, 200, 's')).toBeNull()
  expect(marginsOf([], axis, 200, 's')).toBeNull()
})

it('does not mix units on an axis', () => {
  const mixed = [...points, { x: 7, run: 'R-0007', outcome: outcome({ unit: 's', quantity: 't' }) }]
  expect(commonOf(mixed)).toBeNull()
  expect(marginsOf(mixed, axis, 200, 's')).toBeNull()
  expect(commonOf(points)).toEqual({ quantity: 'd_min', unit: 'm' })
})

it('has room around a single run', () => {
  expect(marginsOf([{ x: 2, run: '', outcome: outcome() }], axis, 1, 's')?.xRange).toEqual([1, 3])
  expect(marginsOf([{ x: 0, run: '', outcome: outcome() }], axis, 1, 's')?.xRange).toEqual([-0.5, 0.5])
})

it('says every run in words', () => {
  expect(kindsOf(points)).toEqual(['cleared', 'violated', 'inconclusive', 'failed', 'purged'])
  expect(spoken(points.slice(1, 4), ({ run }) => run)).toBe('R-0002: Violated, margin −0.1 m; R-0003: Failed; R-0004: Purged')
  expect(spoken([{ x: 1, run: 'R-0001', outcome: outcome({ verdict: 'inconclusive', not_sampled: true }) }], ({ run }) => run)).toBe('R-0001: Inconclusive: not sampled, margin 0.3 m')
  expect(spoken([{ x: 1, run: 'R-0001', outcome: outcome({ policy: 'fails' }) }], ({ run }) => run)).toBe('R-0001: Cleared, policy fails, margin 0.3 m')
  expect(sampleOf(outcome({ violations: 3 }))).toBe('3 of 3\u202f000')
  expect(sampleOf(outcome({ violations: 3, failed_samples: 2 }))).toBe('3 of 3\u202f000, 2 failed')
  expect([observedName(points), observedName([{ x: 1, run: '', outcome: outcome({ failed_samples: 1 }) }])]).toEqual(['Observed fraction', 'Violating or failed fraction'])
  expect([sampleOf(null), sampleOf(outcome(bare)), fractionOf(outcome({ samples: 0 }))]).toEqual(['', '', null])
})
