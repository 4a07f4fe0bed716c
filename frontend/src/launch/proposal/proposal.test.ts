// What a campaign asks for a proposal, and that its searches are stated as the service proposes them.
import { expect, it } from 'vitest'
import type { Campaign } from '../../api/campaign'
import type { Catalogue, Proposal } from '../../client'
import { requestOf, minutesOf, searchesOf, stated } from './proposal'

const CAMPAIGN = {
  name: 'Drop',
  simulator: { name: 'drop' },
  uncertain: { 'simulator.mass': { low: 1, high: 4 }, 'simulator.wind': { low: 0, high: 2 } },
  criterion: { component: '', result: 'separation', threshold: 1 },
  stages: { search: [{ method: 'direct', evaluations: 5000 }] },
} as unknown as Campaign

const CATALOGUE = { methods: [{ name: 'direct' }, { name: 'lq_cma_es' }, { name: 'turbo' }] } as unknown as Catalogue

const PROPOSAL: Proposal = {
  measured: { run: 'R-0012', source: 'R-0012', at: 1, host: '', seconds: 0.42, slots: 2, evaluations: 15, failed: 0 },
  known: '', sentence: '', seconds: 60,
  searches: [
    { method: 'turbo', evaluations: 100, options: { batch: 2 } },
    { method: 'lq_cma_es', evaluations: 100, options: { at_once: 2 } },
  ],
}

it.each([['60', 60], ['0.5', 0.5], ['1 000', 1000], ['0', null], ['-3', null], ['', null], ['soon', null], ['1e99', null], ['527041', null]])(
  'reads %j as minutes',
  (text, minutes) => {
    expect(minutesOf(text)).toBe(minutes)
  },
)

it('asks for the parameters that vary, the time in seconds and the calls of an evaluation', () => {
  expect(requestOf(CAMPAIGN, 60)).toEqual({ simulator: 'drop', parameters: 2, patience: 3600, calls: 1 })
  const calls = (count: string | number | undefined) =>
    requestOf({ ...CAMPAIGN, simulator: { name: 'drop', repeats: { count } } }, 1)?.calls
  expect([calls(7), calls('3'), calls(undefined)]).toEqual([7, 3, 5])
})

it('asks nothing of a campaign for which there can be no proposal', () => {
  expect(requestOf(CAMPAIGN, null)).toBeNull()
  expect(requestOf({ ...CAMPAIGN, uncertain: {} }, 60)).toBeNull()
  expect(requestOf({ ...CAMPAIGN, simulator: { name: '' } }, 60)).toBeNull()
  for (const count of ['many', 0, 2.5, 1001, ''])
    expect(requestOf({ ...CAMPAIGN, simulator: { name: 'drop', repeats: { count } } }, 60), String(count)).toBeNull()
})

it('states the proposed searches in the order of the catalogue, and no method that it lacks', () => {
  const searches = searchesOf(PROPOSAL, CATALOGUE)
  expect(searches.map((s) => [s.method, s.evaluations, s.options])).toEqual([
    ['lq_cma_es', 100, { at_once: 2 }],
    ['turbo', 100, { batch: 2 }],
  ])
  const fewer = { methods: CATALOGUE.methods.filter((m) => m.name !== 'turbo') } as unknown as Catalogue
  expect(searchesOf(PROPOSAL, fewer).map((s) => s.method)).toEqual(['lq_cma_es'])
})

it('recognises a campaign that states the proposal already', () => {
  const searches = searchesOf(PROPOSAL, CATALOGUE)
  const campaign = { ...CAMPAIGN, stages: { search: searches } }
  expect(stated(CAMPAIGN, searches)).toBe(false)
  expect(stated(campaign, searches)).toBe(true)
  const [first, ...rest] = searches
  if (!first) throw new Error('there is no search')
  expect(stated({ ...campaign, stages: { search: [{ ...first, evaluations: 99 }, ...rest] } }, searches)).toBe(false)
  expect(stated({ ...campaign, stages: { search: [{ ...first, options: {} }, ...rest] } }, searches)).toBe(false)
})
