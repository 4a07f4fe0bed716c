// The card of an estimate of P(violation): an interval only where there is no alarm, and which modes no search had found.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import type { EstimationResult } from '../../api/stages'
import type { NamedModes } from '../../client'
import { words } from '../../format/spans'
import { EstimateCard } from './EstimateCard'

const RESULT: EstimationResult = {
  stage: 'estimate', text: 'P(violation) is about 3e-7', statement: [words('P(violation) is about 3e-7')],
  probability: 3e-7, low: 2e-7, high: 4e-7, variation: 0.1, confidence: 0.95, effective: 620, draws: 1650, failed_draws: 0, outside: 0,
  modes: [
    { share: 0.74, parameters: { 'vehicle.m': 5.5 }, distance: 4.8, origins: [{ position: 2, index: 7 }] },
    { share: 0.26, parameters: { 'vehicle.m': 4.2 }, distance: 5.1, origins: [] },
  ],
  alarms: [], seed: 1, drawn_at_launch: true,
}
const parameters = [{ path: 'vehicle.m', symbol: 'm', unit: 'kg', text: '', nominal: 5, low: 4, high: 6 }]
const NAMED: NamedModes = {
  position: 3, findings: [['F2'], []], compared: [['F1', 'F2'], ['F1', 'F2']],
  text: 'of P(violation) 74 % from F2', statement: [words('of P(violation) 74 % from F2')],
}
const html = (more: Partial<EstimationResult> = {}, named: NamedModes | null = NAMED) =>
  renderToStaticMarkup(<EstimateCard parameters={parameters} result={{ ...RESULT, ...more }} named={named} />)
const text = (markup: string) => markup.replace(/<[^>]+>/g, ' ').replace(/\s+/g, ' ').replace(/ \./g, '.')

it('shows the interval, its sentence and the modes with their shares', () => {
  const shown = html()
  expect(shown).toContain('interval 2.0e−7 to 4.0e−7')
  expect(text(shown)).toContain('P(violation) is about 3e-7')
  expect(text(shown)).toMatch(/1 F2 74 % 4\.8\d* a search 5\.5\d* 2 — 26 % 5\.1\d* the estimate 4\.2/)
  expect(text(shown)).toContain('Of P(violation) 74 % from F2.')
  expect(shown).not.toContain('Alarm')
  expect(text(html({}, null))).not.toContain('F2')
})

it('shows the sentence of an alarm, and no interval', () => {
  const said = { text: 'it rests on 18', statement: [words('it rests on 18')] }
  const statement = [words('P(violation) has no interval: it rests on 18')]
  const shown = html({ low: null, high: null, alarms: [{ ...said, why: 'few', value: 18 }], statement })
  expect(shown).toContain('aria-label="Alarm"')
  expect(shown).not.toContain('<rect')
  expect(shown).not.toContain('Share of P')
  expect(text(shown)).toContain('P(violation) has no interval: it rests on 18.')
})

it('states why nothing was estimated, without a number', () => {
  const none = { probability: null, low: null, high: null, effective: null, draws: 0, modes: [] }
  const shown = html({ ...none, statement: [words('P(violation) was not estimated: no violation is known')] })
  expect(text(shown)).toContain('P(violation) was not estimated: no violation is known.')
  expect(shown).not.toContain('<rect')
  expect(shown).not.toContain('weighted draws')
})
