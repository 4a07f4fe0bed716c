// The changes since the baseline as a table: every standing has its word, a missing number is a dash.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import type { FindingChange, Regression } from '../../client'
import { Changes } from './SinceCard'

const change = (more: Partial<FindingChange>): FindingChange => ({
  standing: 'same', before: 'F1', now: 'F1', evaluation: 0, parameters: { 'vehicle.m': 6 }, margin_before: 0.44174,
  margin_again: 0.42813, margin: 0.4, change: -0.01361, tolerance: 0.001, newly_violating: false, fails: false, statement: [],
  text: '', ...more,
})
const regression = (...cases: FindingChange[]): Regression => ({
  run: 'out', position: 1, cases, fail_on: ['worse'], ok: true, accepted: false, quantity: 'd_min', unit: 'm', statement: [], text: '',
})
const shown = (...cases: FindingChange[]) =>
  renderToStaticMarkup(<Changes unit="m" regression={regression(...cases)} choose={() => undefined} />)
const text = (html: string) => html.replace(/<[^>]+>/g, ' ').replace(/\s+/g, ' ')

it('shows the margins, the change and what fails', () => {
  const row = text(shown(change({ standing: 'worse', fails: true })))
  expect(row).toContain('Worse fails F1 F1 +0.44174 +0.42813 +0.40000 −0.014 0.001')
})

it('has a word for every standing', () => {
  const standings = ['new', 'worse', 'same', 'better', 'fixed', 'unresolved', 'not compared'] as const
  const html = shown(...standings.map((standing) => change({ standing })))
  for (const word of ['New', 'Worse', 'Same', 'Better', 'Fixed', 'Not compared']) expect(text(html)).toContain(` ${word} `)
})

it('shows no number that was not computed', () => {
  const lost = change({ standing: 'not compared', now: null, margin_again: null, margin: null, change: null, tolerance: null })
  expect(text(shown(lost))).toContain('Not compared F1 no finding +0.44174 — — — —')
  expect(text(shown(change({ standing: 'new', before: null, margin_before: null })))).toContain('New none F1 —')
})

it('marks a margin that violates', () => {
  expect(shown(change({ margin: -0.1 }))).toContain('bad-t')
  expect(shown(change({}))).not.toContain('bad-t')
})
