// The sections of a run that has ended: which there are, in which order, and where the sensitivity stands.
import { expect, it, vi } from 'vitest'
import { asCampaign } from '../api/campaign'
import { finding, flight, progress, run, search, stage, validated } from '../../tests/fixtures'
import type { EstimateResult, SensitivityResult } from '../client'
import type { RunData } from './data/data'
import { factsOf } from './facts'
import type { Page } from './section'
import type { Added } from './section'
import { SECTIONS } from './sections'

// Reads the theme of the document, which there is none of here.
vi.mock('../theme/useTheme', () => ({ useTheme: () => 'light' }))

const data = (more: Partial<RunData> = {}): RunData => {
  const ended = more.run ?? run()
  return {
    run: ended, campaign: asCampaign(ended.campaign), catalogue: undefined, parameters: [], stages: [], evaluations: undefined,
    findings: [], traces: [], nominalTrace: undefined, chosen: 'nominal', finding: null, findingTrace: undefined,
    complete: true, missing: [], ...more,
  }
}
const page = (more: Partial<RunData> = {}) => ({ ...factsOf(data(more)), data: data(more) }) as Page
const tabs = (more: Partial<RunData> = {}) => SECTIONS.flatMap((one) => one.tab(page(more))?.name ?? [])
const rows = (more: Partial<RunData> = {}) => SECTIONS.filter((one) => one.content(page(more))).map(({ id }) => id)

const curve = { curves: [] as SensitivityResult['curves'] }
const sensitivity = (curves: number) =>
  stage({ ...curve, stage: 'sensitivity', curves: Array.from({ length: curves }) } as unknown as SensitivityResult)
const speed = { name: 'v', unit: 'm/s', group: 'state', text: '' } as const
const flown = { nominalTrace: flight({ name: 'nominal', columns: [speed] as never }) }

it('always has provenance, sign-off and notes', () => {
  expect(tabs()).toEqual(['Provenance', 'Sign-off', 'Notes'])
  expect(rows()).toEqual(['provenance', 'signoff', 'notes'])
})

it('states what to do with a failed run, and its parameters if it has no case', () => {
  const failed = run({ state: 'failed' })
  expect(rows({ run: failed }).slice(0, 2)).toEqual(['parameters', 'what-to-do'])
  expect(rows({ run: failed, ...flown }).slice(0, 3)).toEqual(['what-to-do', 'flight', 'cases'])
})

it('has few curves next to the separation, and many in their own row after the speeds', () => {
  const few = ['flight', 'cases', 'separation', 'sensitivity', 'motion', 'provenance', 'signoff', 'notes']
  expect(rows({ ...flown, stages: [sensitivity(2)] })).toEqual(few)
  const many = ['flight', 'cases', 'separation', 'motion', 'sensitivity', 'provenance', 'signoff', 'notes']
  expect(rows({ ...flown, stages: [sensitivity(3)] })).toEqual(many)
  expect(tabs({ ...flown, stages: [sensitivity(3)] }).slice(0, 4)).toEqual(['3D view', 'Separation', 'Speeds and commands', 'Sensitivity'])
})

it('has the tornado next to the flight if the table is short, else next to the curves', () => {
  const parameters = Array.from({ length: 5 }, (_, i) => ({ path: `p${i}`, symbol: '', unit: '', text: '', nominal: 0, low: 0, high: 1 }))
  expect(rows({ ...flown, stages: [sensitivity(3)] })).not.toContain('tornado')
  expect(rows({ ...flown, parameters, stages: [sensitivity(3)] })).toContain('tornado')
})

it('has the estimate of P(violation) if the run made one, after the sample', () => {
  const estimate = stage({ stage: 'estimate', alarms: [], modes: [] } as unknown as EstimateResult)
  expect(rows({ stages: [estimate] })).toContain('estimate')
  expect(tabs({ stages: [estimate] })[0]).toBe('Estimate')
  expect(rows()).not.toContain('estimate')
  expect(page({ stages: [stage({ ...estimate.result, drawn_at_launch: true } as EstimateResult)] }).certified).toBe(false)
})

it('counts what it lists', () => {
  const searched = run({ stages: [progress({ method: 'direct' }), progress({ method: 'sqp', evaluations: 0 })], failed_evaluations: 3, excluded_evaluations: 2 })
  const failures = [{ position: 2, index: 0, status: 'failed', reason: '', parameters: {} } as const]
  const found = { run: searched, findings: [finding('F1')], evaluations: { criteria: [], stages: [], failures } }
  const counts = Object.fromEntries(SECTIONS.flatMap((one) => one.tab(page(found)) ?? []).map(({ id, count }) => [id, count]))
  expect(counts).toEqual({ findings: 1, methods: 2, failures: 5, provenance: undefined, signoff: undefined, notes: undefined })
})

it('takes the sample of a search where certify has none, and published values leave the columns for it', () => {
  const sample = { samples: 300 } as never
  const verdict = run({ verdict: 'cleared' as never, campaign: { ...run().campaign, published: [{}] as never } })
  const pieces = (more: Partial<RunData>) => SECTIONS.flatMap((one) => (Object.keys(one.content(page(more)) ?? {}).includes('pieces') ? one.id : []))
  expect(pieces({ run: verdict, stages: [stage(validated())] })).toEqual(['validation', 'published'])
  const drawn = { run: verdict, stages: [stage(search({ sample })), stage(validated())] }
  expect(pieces(drawn)).toEqual(['sample', 'validation'])
  expect(rows(drawn)).toContain('published')
})

it('has no two sections under one anchor', () => {
  for (const more of [{}, flown, { ...flown, stages: [sensitivity(2)] }, { ...flown, stages: [sensitivity(3), stage(validated())] }]) {
    const ids = SECTIONS.flatMap((one) => one.tab(page(more))?.id ?? [])
    expect(new Set(ids).size).toBe(ids.length)
  }
})

it('the section of every file is on the page, where its file says', () => {
  const added = Object.values(import.meta.glob<Added>('./stages/*.tsx', { eager: true, import: 'added' }))
  expect(added.length).toBeGreaterThan(0)
  for (const { after, section } of added) {
    const at = SECTIONS.indexOf(section)
    expect(SECTIONS.slice(0, at).map(({ id }) => id)).toContain(after)
  }
})
