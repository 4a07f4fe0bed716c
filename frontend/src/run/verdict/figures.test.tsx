// The figure of the worst case names the evaluation that found it, also where a method is searched with twice.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { finding, progress, run } from '../../../tests/fixtures'
import { asCampaign } from '../../api/campaign'
import { FiveFigures } from './FiveFigures'

const found = (worst_cost: number, ...bests: [best: number | null, best_index: number | null][]) => {
  const stages = bests.map(([best, best_index], position) => progress({ position, method: 'direct', best, best_index }))
  const of = run({ worst_cost, margin: worst_cost - 1, worst_method: 'direct', stages })
  const findings = [finding('F1', { cost: worst_cost, methods: ['direct'], found: [{ method: 'direct' }] as never })]
  const html = renderToStaticMarkup(<FiveFigures data={{ run: of, campaign: asCampaign(of.campaign), findings, stages: [] }} />)
  return /DIRECT[^<]*/.exec(html)?.[0]
}

it('names the evaluation of the stage whose value is the lowest', () => {
  expect(found(0.5, [0.9, 3], [0.5, 41])).toBe('DIRECT, evaluation 42')
  expect(found(0.5, [0.5, 41], [0.9, 3])).toBe('DIRECT, evaluation 42')
  expect(found(0.5, [null, null], [0.5, 41])).toBe('DIRECT, evaluation 42')
  expect(found(0.4, [0.9, 3], [0.5, 41])).toBe('DIRECT, refined in validation')
})

const bound = (upper_bound: number, target_probability: number) => {
  const statistics = { source: 'certify', samples: 300, violations: 0, failed: 0, excluded: 0, confidence: 0.9496, upper_bound, noise: 'none' }
  const of = run({ summary: { statistics } as never })
  const campaign = { ...asCampaign(of.campaign), target_probability }
  return renderToStaticMarkup(<FiveFigures data={{ run: of, campaign, findings: [], stages: [] }} />)
}

it('never shows a bound above the target as one that meets it, nor a higher confidence', () => {
  const html = bound(0.0124, 0.01239999)
  expect(html).toContain('>1.24<')
  expect(html).toContain('target 1.239999\u202f%')
  expect(html).toContain('94.96\u202f% upper bound')
})
