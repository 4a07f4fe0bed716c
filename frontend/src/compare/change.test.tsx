// What the compare page states of two runs: a change only where more than the search differs, numbers only of ended searches.
import { QueryClient, QueryClientProvider } from '@tanstack/react-query'
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it, vi } from 'vitest'
import { finding, progress, run } from '../../tests/fixtures'
import { codeQuery } from '../api/queries'
import type { CodeChanges, RunDetail, RunState } from '../client'
import { NONE } from '../format/numbers'
import { words } from '../format/spans'
import { Change } from './Change'
import type { Compared } from './data'
import { FindingMargins } from './FindingMargins'
import { Methods } from './Methods'
import { Results } from './Results'

// Reads the catalogue that a page has loaded, which there is none of here.
const LOOK = { colour: '', colours: null, shape: 'ring', title: 'DIRECT', short: 'DIRECT' }
vi.mock('../ui/methods', async (real) => ({ ...(await real<object>()), useMethodLook: () => () => LOOK }))

const compared = (letter: string, worst: number | null, more: Partial<RunDetail> = {}): Compared => ({
  id: `R-${letter}`, letter, dash: [], stages: [], evaluations: undefined, nominal: undefined, worst: undefined, catalogue: undefined, parameters: [], parts: {},
  findings: [finding('F1', { margin: (worst ?? 1) - 1 })],
  run: run({
    ...{ id: `R-${letter}`, verdict: worst !== null && worst <= 1 ? 'violated' : 'cleared', worst_cost: worst, margin: worst === null ? null : worst - 1 },
    ...{ stages: [progress({ method: 'direct', best: worst })], campaign_digest: letter, ...more },
  }),
})
const unended = (letter: string, state: RunState, worst: number | null, more: Partial<RunDetail> = {}) =>
  compared(letter, worst, { state, verdict: null, ...more })
const SAME: CodeChanges = { code: 'a', against: 'a', changes: [], unidentified: [], same_model: true, same_question: true, files: [] }

const shown = (runs: Compared[], code?: Partial<CodeChanges>) => {
  const cache = new QueryClient()
  const [a, b] = runs
  if (code) cache.setQueryData(codeQuery(b?.id ?? '', a?.id ?? '').queryKey, { ...SAME, ...code })
  const part = (of: React.ReactNode) =>
    renderToStaticMarkup(<QueryClientProvider client={cache}>{of}</QueryClientProvider>).replace(/<svg.*?<\/svg>/g, '').replace(/<[^>]+>/g, ' ').replace(/\s+/g, ' ').replace(/d min/g, 'd_min').replace(/ ([,.;:])/g, '$1').trim()
  return { change: part(<Change runs={runs} />), tables: part(<><Results runs={runs} /><Methods runs={runs} className="" /><FindingMargins runs={runs} /></>) }
}
const campaign = (changes: Record<string, unknown>) => ({ campaign: { ...run().campaign, ...changes } })

it('states no change where only the search differs, and what speaks against a run', () => {
  const runs = [compared('A', -0.2), compared('B', 3, { against: 'R-A violates the criterion, on the same question and model.' })]
  const { change, tables } = shown(runs, {})
  expect(change).toContain('A violated; B cleared')
  expect(change).toContain('The worst d_min is −0.200 m in A and 3.000 m in B, 3.20 m higher')
  expect(change).toContain('Question and model are the same: the search of B did not find the lower value of A.')
  expect(change).toContain('Against B: R-A violates the criterion')
  expect(change).not.toMatch(/rises|falls|From/)
  expect(tables).toContain('B minus A')
  expect(shown(runs.toReversed(), {}).change).toContain('found a lower value than that of A.')
  expect(shown(runs, { unidentified: ['engine'] }).change).toContain('and the model as far as it is identified:')
  // Methods, seed and distributions ask nothing else.
  expect(shown([compared('A', -0.2), compared('B', 3, campaign({ seed: 2, confidence: 0.9 }))], {}).change).toContain('Question and model are the same')
  // Until the code is loaded, nothing is known of the model.
  expect(shown(runs).change).not.toContain('model are')
})

it('names what differs in the question or the model', () => {
  const bounds = (high: number) => campaign({ uncertain: { 'vehicle.m': { low: 4, high } } })
  const wider = [compared('A', 3, bounds(6)), compared('B', -0.2, bounds(8))]
  const other = { same_question: false }
  expect(shown(wider, other).change).toContain('From cleared to violated')
  expect(shown(wider, other).change).toContain('The runs differ in: the bounds of vehicle.m.')
  expect(shown(wider, { ...other, same_model: false }).change).toContain('The runs differ in: the bounds of vehicle.m; the code of the model.')
  const model = shown([compared('A', 3), compared('B', -0.2)], { same_model: false }).change
  expect(model).toContain('From cleared to violated')
  expect(model).toContain('3.20 m lower')
  expect(model).toContain('The runs differ in: the code of the model.')
})

it('states no change of the verdict where the service finds the same question', () => {
  const repeated = (repeats: number) => campaign({ simulator: { name: 'basins', repeats } })
  const { change } = shown([compared('A', -0.2, repeated(3)), compared('B', 3, repeated(1))], {})
  expect(change).toContain('A violated; B cleared')
  expect(change).toContain('The runs differ in: simulator.repeats.')
  // Not known of runs of an earlier version.
  expect(shown([compared('A', -0.2, repeated(3)), compared('B', 3, repeated(1))], { same_question: null }).change).toContain('From violated to cleared')
  expect(shown([compared('A', -0.2), compared('B', 3)], { same_question: false }).change).not.toContain('are the same')
})

it('states no change of the verdict where one run found within other bounds what the other missed', () => {
  const bounds = (high: number) => campaign({ uncertain: { 'vehicle.m': { low: 4, high } } })
  const narrow = compared('A', -0.2, bounds(6))
  const wide = compared('B', 3, { ...bounds(8), against: 'R-A violates the criterion, in a case within these bounds, on the same model.', against_runs: ['R-A'] })
  for (const runs of [[narrow, wide], [wide, narrow]]) expect(shown(runs, { same_question: false }).change).not.toContain('From')
  expect(shown([narrow, wide], { same_question: false }).change).toContain('A violated; B cleared: contradicted')
})

it('compares no number of a search that has not ended', () => {
  for (const [state, how] of [['cancelled', 'was cancelled: its search did not end'], ['failed', 'failed: its search did not end'], ['running', 'is running: its search has not ended']] as const) {
    const { change, tables } = shown([compared('A', -0.2), unended('B', state, 3)])
    expect(change).toContain(`A violated; B ${state}`)
    expect(change).toContain(`The worst d_min of A is −0.2000 m. B ${how}, and the lowest d_min so far is 3.000 m.`)
    expect(change).not.toMatch(/higher|lower value|margin/)
    expect(tables).not.toContain('B minus A')
    expect(tables).toContain('B so far')
    expect(tables).not.toContain('A so far')
  }
  expect(shown([compared('A', -0.2), unended('B', 'queued', null)]).change).toContain('B is queued: its search has not ended.')
  const found = unended('B', 'cancelled', 0.5, { unconfirmed: [words('No verdict confirms it.')] })
  expect(shown([compared('A', 3), found]).change).toContain('so far is 0.5000 m. No verdict confirms it.')
})

it('names the smallest margin among runs that are done', () => {
  const runs = [compared('A', 3), compared('B', 2), unended('C', 'running', -0.5)]
  const { change } = shown(runs)
  expect(change).toContain('The smallest margin of the runs that are done is that of B: +1.000 m. C is running')
  expect(change).toContain('the lowest d_min so far is −0.5000 m')
  expect(shown([compared('A', 3), compared('B', 2), compared('C', 4)]).change).toContain('The smallest margin is that of B')
})

it('subtracts no bounds of other confidences or thresholds', () => {
  const bounded = (letter: string, confidence: number, threshold: number) => {
    const one = compared(letter, 3, { threshold })
    const statistics = { samples: 300, violations: letter === 'B' ? 1 : 0, upper_bound: letter === 'A' ? 0.02 : 0.01, confidence }
    return { ...one, run: { ...one.run, upper_bound: statistics.upper_bound, summary: { statistics } } } as unknown as Compared
  }
  const apart = (a: Compared, b: Compared) => {
    const html = renderToStaticMarkup(<Results runs={[a, b]} />)
    return ['bound', 'violations'].map((key) => (new RegExp(`<tr data-row="${key}">.*?</tr>`).exec(html)?.[0] ?? '').split(/<td[^>]*>/).at(-1)?.replace(/<.*/, '').replace('\u202f', ' '))
  }
  expect(apart(bounded('A', 0.95, 1), bounded('B', 0.95, 1))).toEqual(['−1 %', '+1'])
  expect(apart(bounded('A', 0.95, 1), bounded('B', 0.9, 1))).toEqual([NONE, '+1'])
  expect(apart(bounded('A', 0.95, 1), bounded('B', 0.95, 2))).toEqual([NONE, NONE])
})
