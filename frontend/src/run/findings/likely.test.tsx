// How likely findings are: numbers only where they were computed, and the most likely violation as what it is.
import { QueryClient, QueryClientProvider } from '@tanstack/react-query'
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { finding, run } from '../../../tests/fixtures'
import { asCampaign } from '../../api/campaign'
import { mostLikelyQuery } from '../../api/queries'
import type { Likelihood, MostLikely } from '../../client'
import { NONE } from '../../format/numbers'
import { words } from '../../format/spans'
import type { RunData } from '../data/data'
import { isLikely, LikelyCell, LikelySentence, LikelyViolation, MostLikelyRow } from './Likely'

const text = (html: string) => html.replace(/<[^>]+>/g, ' ').replace(/\s+/g, ' ').replace(/ \./g, '.').trim()
const said = (sentence: string) => ({ text: sentence, statement: [words(sentence)] })
const NORMAL: Likelihood = { ...said('4 standard deviations away'), density: 0.000335, distance: 4, tail: 0.0000633, parameters: 1 }
const BOX: Likelihood = { ...said('all points of the box are equally likely'), density: null, distance: null, tail: null, parameters: 0 }
const ended = run()
const data = {
  run: ended, campaign: asCampaign(ended.campaign), findings: [finding('F1', { likelihood: NORMAL })],
  parameters: [{ path: 'vehicle.m', symbol: 'm', unit: 'kg', text: '', nominal: 5, low: 4, high: 6 }],
} as unknown as RunData
const MOST: MostLikely = {
  ...said('the most likely of the 12 stored violations, not of all'), violations: 12,
  case: { position: 2, index: 700, cost: 0.9, margin: -0.1, parameters: { 'vehicle.m': 5.5 }, realisation: null, likelihood: NORMAL },
}
const row = (most: MostLikely) => renderToStaticMarkup(<LikelyViolation data={data} decimals={2} between={2} most={most} />)

it('shows distance and draws of a finding, and nothing in their place where no number was computed', () => {
  expect(text(renderToStaticMarkup(<LikelyCell likelihood={NORMAL} />))).toBe('4 6.3e−5 of draws')
  expect([BOX, null].map((likelihood) => text(renderToStaticMarkup(<LikelyCell likelihood={likelihood} />)))).toEqual([NONE, NONE])
})

it('has a column only where likelihood distinguishes findings', () => {
  expect(isLikely(data.findings)).toBe(true)
  expect(isLikely([finding('F1', { likelihood: BOX }), finding('F2')])).toBe(false)
})

it('states of a box that all points are equally likely', () => {
  const sentence = (likelihood: Likelihood | null) => text(renderToStaticMarkup(<LikelySentence data={{ finding: finding('F1', { likelihood }) }} />))
  expect(sentence(BOX)).toBe('All points of the box are equally likely.')
  expect(sentence(NORMAL)).toBe('Likelihood of F1 under the stated distributions: 4 standard deviations away.')
  expect(sentence(null)).toBe('')
})

it('shows the most likely violation as one of those that were evaluated, and none where there is none', () => {
  const shown = text(row(MOST))
  expect(shown).toContain('Most likely violation 0.90 −0.10 4')
  expect(shown).toContain('The most likely of the 12 stored violations, not of all.')
  expect(row({ ...MOST, case: null })).toBe('')
})

it('shows the most likely violation also where no density is stated as a fraction of the highest, without a number', () => {
  const likelihood: Likelihood = { ...BOX, ...said('no likelihood is stated: a is correlated but not normal'), parameters: 2 }
  const skewed = { ...data, findings: [finding('F1', { likelihood })] }
  const most: MostLikely = { ...MOST, case: MOST.case && { ...MOST.case, likelihood } }
  const shown = text(renderToStaticMarkup(<LikelyViolation data={skewed} decimals={2} between={2} most={most} />))
  expect(shown).toContain('Most likely violation 0.90 −0.10 The most likely of')
  const client = new QueryClient()
  client.setQueryData(mostLikelyQuery(ended.id).queryKey, most)
  const inTable = (of: RunData) =>
    text(renderToStaticMarkup(<QueryClientProvider client={client}><MostLikelyRow data={of} decimals={2} between={2} /></QueryClientProvider>))
  expect(inTable({ ...skewed, findings: [finding('F1', { likelihood, margin: -0.1 })] })).toBe(shown)
  expect(inTable({ ...skewed, findings: [finding('F1', { likelihood: BOX, margin: -0.1 })] })).toBe('')
})
