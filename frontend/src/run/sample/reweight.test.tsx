// Sliders over the distributions: what they move, what is requested, and that numbers are shown only where there are any.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { run } from '../../../tests/fixtures'
import { asCampaign, type Uncertain } from '../../api/campaign'
import type { Reweighted } from '../../client'
import { NONE } from '../../format/numbers'
import { words } from '../../format/spans'
import { keyOf, knobsOf, requestOf } from './moved'
import { Estimates, Said } from './ReweightCard'

const text = (html: string) => html.replace(/<[^>]+>/g, ' ').replace(/\s+/g, ' ').replace(/ \./g, '.').trim()
const parameter = (path: string) => ({ path, symbol: path, unit: 'kg', text: '', nominal: 5, low: 4, high: 6 })
const data = (uncertain: Record<string, Uncertain>) => ({
  campaign: { ...asCampaign(run().campaign), uncertain }, parameters: Object.keys(uncertain).map(parameter),
})
const NORMAL: Uncertain = { plus_minus: '20%', unit: 'kg', distribution: { kind: 'normal', mean: 5, deviation: 0.3 } }
const BOX: Uncertain = { low: 4, high: 6, distribution: { kind: 'uniform' } }

const found: Reweighted = {
  text: '', statement: [words('P(violation) is estimated as 2 %')], samples: 3000, violations: 60, failed: 0, excluded: 0, effective: 2400.7, needed: 100,
  outside: 0, confidence: 0.95, probability: 0.02, low: 0.015, high: 0.026, quantiles: [{ share: 0.05, value: 0.91 }, { share: 0.5, value: null }],
}
const refused: Reweighted = { ...found, statement: [words('no estimate: too few draws')], effective: 22.8, probability: null, low: null, high: null, quantiles: [] }

it('has a slider for every parameter of a distribution, and for the bounds of a uniform one', () => {
  const knobs = knobsOf(data({ 'a.m': NORMAL, 'a.J': BOX, 'a.t': { low: 4, high: 6, distribution: { kind: 'triangular', mode: 5 } } }))
  expect(knobs.map(keyOf)).toEqual(['a.m mean', 'a.m deviation', 'a.J low', 'a.J high', 'a.t mode'])
  const [mean, deviation, low, high] = knobs
  expect([mean?.low, mean?.high, mean?.stated]).toEqual([4, 6, 5])
  expect(deviation?.low).toBeCloseTo(0.1)
  expect(deviation?.high).toBeCloseTo(0.6)
  // Bounds stay within those of the draws, and cannot cross.
  expect([low?.low, high?.high]).toEqual([4, 6])
  expect(low?.high).toBeLessThan(high?.low ?? 0)
})

it('requests what was moved, and leaves the rest as stated', () => {
  const of = data({ 'a.m': NORMAL, 'a.J': BOX })
  const request = (moved: Record<string, number>) => requestOf(knobsOf(of), moved, of.campaign)
  expect(request({})).toEqual({ uncertain: {} })
  expect(request({ 'a.m mean': 5 })).toEqual({ uncertain: {} })
  expect(request({ 'a.m mean': 5.2, 'a.m deviation': 0.4 })).toEqual({
    uncertain: { 'a.m': { plus_minus: '20%', distribution: { kind: 'normal', mean: 5.2, deviation: 0.4 } } },
  })
  expect(request({ 'a.J low': 4.5 })).toEqual({ uncertain: { 'a.J': { low: 4.5, high: 6 } } })
})

it('shows stated and moved estimates side by side', () => {
  const shown = text(renderToStaticMarkup(<Estimates run={run()} stated={found} moved={{ ...found, probability: 0.05, effective: 900.2 }} />))
  expect(shown).toContain('P(violation) 2 % 5 %')
  expect(shown).toContain('Interval, 95 % 1.5 % to 2.6 %')
  expect(shown).toContain(`50 % quantile of d min , m ${NONE} ${NONE}`)
  expect(shown).toContain('Effective sample size 2 400 900')
})

it('shows no number of an estimate that is refused, and the reason', () => {
  const shown = text(renderToStaticMarkup(<Estimates run={run()} stated={found} moved={refused} />))
  expect(shown).toContain(`P(violation) 2 % ${NONE}`)
  expect(shown).toContain('Effective sample size 2 400 22')
  expect(text(renderToStaticMarkup(<Said found={refused} why={null} />))).toBe('No estimate: too few draws.')
  expect(text(renderToStaticMarkup(<Said found={found} why="A moved distribution does not fit its bounds." />))).toBe('A moved distribution does not fit its bounds.')
})
