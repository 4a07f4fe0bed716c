// Validated cases: the nominal case from the stage's result, each finding's from the finding.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { finding, run, validated, validation } from '../../tests/fixtures'
import type { FindingDetail, ValidateResult } from '../client'
import { NONE } from '../format/numbers'
import { basinText } from './search/MethodsTable'
import { casesOf, validatedWord } from './data/validated'
import { ValidationCard } from './verdict/ValidationCard'

const text = (html: string) => html.replace(/<[^>]+>/g, ' ').replace(/\s+/g, ' ')
const card = (result: ValidateResult, findings: FindingDetail[]) =>
  text(renderToStaticMarkup(<ValidationCard data={{ run: run(), stages: [], parameters: [], findings }} result={result} />))

const neighbours = { flown: 200, failed: 0, lowest: 0.4, lower_by: 0.1 }
const WORST = finding('F1', { validation: validation({ name: 'F1', violates: true, neighbours }) })
const SECOND = finding('F2', { validation: validation({ name: 'F2', ok: false, agrees: false, realisation: 7 }) })

it('lists the nominal case, then every finding by its own validation', () => {
  const shown = card(validated(), [WORST, SECOND])
  const at = ['Nominal', 'Integrations agree', 'Worst, F1', 'Violation confirmed', 'F2', 'Integrations disagree', 'noise seed 7']
  const places = at.map((words) => shown.indexOf(words))
  expect(places.every((place) => place > 0)).toBe(true)
  expect(places).toEqual([...places].sort((a, b) => a - b))
  expect(shown).toContain('200 neighbours of the worst case were simulated: the lowest is 0.1 m lower')
})

it('omits what an earlier version did not store, and states where nothing is left', () => {
  const bare = finding('F1', { validation: null })
  expect(casesOf(validated(), [bare, SECOND]).map(({ name }) => name)).toEqual(['nominal', 'F2'])
  expect(card(validated({ nominal: null }), [bare])).toContain('The cases are not stored.')
  expect(card(validated(), [bare])).not.toContain('not stored')
})

it('has fewer words for a validation that does not tell how it came out', () => {
  const earlier = { agrees: null, violates: null }
  expect([true, false].map((ok) => validatedWord({ ok, ...earlier }))).toEqual(['Validated', 'Not validated'])
  expect(validatedWord({ ok: true, agrees: false, violates: true })).toBe('Violation confirmed, beyond tolerance')
})

it('counts the random evaluations that validation could not afford among those that it chose', () => {
  const spot_checks = { checked: 142, compared: 140, largest: 0, median: 0, violating: 0, at: null, reasons: [], statement: [], text: '' }
  const violations = { stored: 0, checked: 0, confirmed: 0, statement: [], text: '' }
  const left_out = { findings: 0, violations: 0, calls: 0, spot_checks: 58 }
  const result = validated({ spot_checks, violations, spent: { at_most: 300, stored: 12, left_out } } as never)
  expect(card(result, [WORST])).toContain('140 of 200 compared')
})

it('shows in how many independent calls a case of a noisy simulator violates', () => {
  const repeats = {
    values: [...Array<number>(7).fill(0.4), 1.2, 1.3, null], reasons: ['no answer within 5 s'], violating: 7, failed: 1,
    confidence: 0.95, low: 0.35, high: 0.97, statement: [], text: 'violates in 7 of 10, 1 failed [0.35, 0.97]',
  }
  const shown = card(validated(), [finding('F1', { validation: validation({ name: 'F1', violates: true, repeats }) })])
  expect(shown).toContain('Violates in 7 of 10, 1 failed [0.35, 0.97]')
  expect(shown).toContain('Lowest of 10 independent calls')
  expect(shown).toContain('As searched')
})

it('states that no finding contains a best value only where basins were stored', () => {
  expect(basinText({ basin: 'F2' }, true)).toBe('F2')
  expect(basinText({ basin: null }, true)).toBe('no finding')
  expect([basinText({ basin: null }, false), basinText(undefined, true)]).toEqual([NONE, NONE])
})
