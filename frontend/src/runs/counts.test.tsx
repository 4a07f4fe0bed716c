// Evaluations without a value are reported consistently next to every count, margin and check.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { asCampaign } from '../api/campaign'
import * as fixtures from '../../tests/fixtures'
import { boundsOf } from '../charts/outcomes'
import type { Checked, DescribedCheck, Outcome, RunDetail, StageDetail, StageProgress } from '../client'
import type { Compared } from '../compare/data'
import { Results } from '../compare/Results'
import { shareOf, withoutValue } from '../format/counts'
import { Estimate } from '../launch/Side'
import { COLUMNS } from '../runs/columns'
import { FoundBy } from '../run/findings/FindingsCard'
import { Standing } from '../run/verdict/Banner'
import { countsOf } from '../run/search/failed'
import { FiveFigures } from '../run/verdict/FiveFigures'
import { boundSoFar, StageStrip } from '../run/search/StageStrip'
import { boundOf } from '../trends/cells'

const stage = (kind: StageProgress['kind'], evaluations: number, failed: number, excluded: number, position: number) =>
  fixtures.progress({ position, kind, method: kind === 'search' ? 'direct' : null, planned: evaluations, evaluations, failed, excluded, best: 1, best_index: 0 })
const STAGES = [stage('nominal', 1, 0, 0, 0), stage('search', 1000, 7, 5, 1), stage('certify', 320, 4, 20, 2), stage('validate', 50, 1, 0, 3)]
const RUN = fixtures.run({
  verdict: 'inconclusive', threshold: 0.5, nominal_cost: 0.94,
  worst_cost: 0.84, margin: 0.34, worst_method: 'direct', evaluations: 1371, planned: 1371, failed_evaluations: 12,
  excluded_evaluations: 25, upper_bound: 0.01,
  plan: STAGES.map(({ kind, title }) => ({ kind, title, description: '' })), stages: STAGES,
  summary: fixtures.verdict({
    statistics: {
      samples: 300, violations: 4, failed: 4, excluded: 20, excluded_fraction: null, confidence: 0.95, upper_bound: 0.03,
      noise: null, quantile: null, source: 'certify', text: '', statement: [],
    },
  }),
})

const text = (html: string) => html.replace(/<[^>]+>/g, '').replaceAll('\u202f', ' ')
const figures = (run: RunDetail) => renderToStaticMarkup(<FiveFigures data={{ run, campaign: asCampaign(run.campaign), findings: [], stages: [] }} />)
const cell = (key: string, run: RunDetail) => {
  const column = COLUMNS.find((c) => c.key === key)
  return renderToStaticMarkup(<>{column?.cell(run, { units: false, now: 0, onTag: () => undefined, onLabel: () => undefined })}</>)
}

it('counts the same in figures, strip, list and table', () => {
  expect(withoutValue(RUN)).toBe('12 failed, 25 excluded')
  expect(text(figures(RUN))).toContain('1 37112 failed, 25 excluded')
  expect(text(figures(RUN))).toContain('4 of 300 samples failed and count as violations; 20 draws excluded')
  const strip = text(renderToStaticMarkup(<StageStrip run={RUN} />))
  for (const statement of ['1 000 done, 7 failed, 5 excluded', '320 done, 4 failed, 20 excluded', '50 done, 1 failed'])
    expect(strip).toContain(statement)
  expect([cell('evaluations', RUN), cell('failed', RUN), cell('excluded', RUN)].map(text)).toEqual(['1 371', '12', '25'])
  expect(countsOf(STAGES, undefined)).toEqual([
    { status: 'failed', count: 12 },
    { status: 'excluded', count: 25 },
  ])
})

it('shows no margin without the evaluations that have none', () => {
  const whole = { ...RUN, failed_evaluations: 0 }
  const statement = '12 of 1 371 evaluations failed and have no margin'
  expect(text(figures(RUN))).toContain(statement)
  expect(cell('margin', RUN).replaceAll('\u202f', ' ')).toContain(statement)
  expect(cell('margin', RUN)).not.toContain('--ok-solid')
  expect(text(figures(whole))).not.toContain('no margin')
  expect(cell('margin', whole)).toContain('--unk-solid')
  expect(cell('margin', { ...whole, verdict: 'cleared' })).toContain('--ok-solid')
})

/** What a bound rests on in words, where its seed was not drawn at the launch. */
const SOURCES: Record<NonNullable<Outcome['bound_source']>, string[]> = { certify: [], certify_stated: ['stated seed'], search: ['random search'] }
const sourcesIn = (html: string) => Object.values(SOURCES).flat().filter((words) => text(html).includes(words))

it.each(['certify', 'certify_stated', 'search'] as const)('states what a bound rests on in every place: %s', (bound_source) => {
  const of = { ...RUN, bound_source }
  const outcome = { state: 'done', upper_bound: 0.01, bound_source } as Outcome
  const compared = [{ id: 'R-0001', letter: 'A', dash: [], findings: [], parameters: [], stages: [], run: of }]
  const places = {
    list: cell('bound', of),
    figures: figures(of),
    tables: boundOf(outcome),
    charts: String(boundsOf([{ x: 0, run: '', outcome }], { xTitle: '', xText: String }, 200, 's')?.lines[0]?.texts),
    compare: renderToStaticMarkup(<Results runs={compared as unknown as Compared[]} />),
  }
  for (const [place, html] of Object.entries(places)) expect([place, sourcesIn(html)]).toEqual([place, SOURCES[bound_source]])
})

it('states what a bound leaves out in every place', () => {
  const of = { ...RUN, upper_bound: 0.01, bound_source: 'certify', excluded_fraction: 0.75 } as const
  const outcome = of as unknown as Outcome
  const compared = [{ id: 'R-0001', letter: 'A', dash: [], findings: [], parameters: [], stages: [], run: of }]
  const places = [
    cell('bound', of),
    boundOf(outcome),
    String(boundsOf([{ x: 0, run: '', outcome }], { xTitle: '', xText: String }, 200, 's')?.lines[0]?.texts),
    renderToStaticMarkup(<Results runs={compared as unknown as Compared[]} />),
  ]
  for (const place of places) expect(text(place)).toMatch(/75.% of draws excluded/)
  expect(cell('bound', { ...of, excluded_fraction: 0 })).not.toContain('excluded')
})

it('predicts the bound, what it rests on and what is out of reach before the launch, as the check answers', () => {
  const predicted = (predicted_bound: Checked['predicted_bound'], foreseen: Checked['foreseen'] = []) =>
    renderToStaticMarkup(<Estimate checked={{ estimate: null, predicted_bound, foreseen } as Checked} campaign={asCampaign(RUN.campaign)} />)
  const of = { samples: 1300, outside: 0, upper_bound: 0.00994, statement: 'None of the 1,300 samples violates.', warning: null }
  for (const source of ['certify', 'search'] as const) {
    const html = predicted({ ...of, source })
    expect(sourcesIn(html)).toEqual(SOURCES[source])
    for (const words of ['0.994 %', '1 300 samples']) expect(text(html).replaceAll('\u202f', ' ')).toContain(words)
    expect(html).not.toContain('role="note"')
  }
  const warned = predicted({ ...of, source: 'certify' }, [{ code: 'target', statement: 'The target cannot be met.' }])
  expect(warned).toMatch(/role="note".*The target cannot be met\./)
  expect(text(predicted(null))).not.toContain('Bound')
})

it.each([[true, false], [false, true]])('names what drew a case that no search found: seed drawn %s', (drawn_at_launch, named) => {
  const found = fixtures.finding('F1', { methods: [], found: [], validation: fixtures.validation({ realisation: 7 }) })
  const stages = [fixtures.stage({ grid: null, drawn_at_launch } as StageDetail['result'])]
  const worst = renderToStaticMarkup(<FiveFigures data={{ run: RUN, campaign: asCampaign(RUN.campaign), findings: [found], stages }} />)
  for (const html of [worst, renderToStaticMarkup(<FoundBy finding={found} stages={stages} />)]) {
    expect(text(html).includes('a random sample with a stated seed')).toBe(named)
    expect(text(html).includes('the independent sample')).toBe(!named)
  }
})

it('writes within the bounds where what is beyond them is not known', () => {
  const so_far = { samples: 100, violations: 0, failed: 0, upper_bound: 0.03, at_end: 0.01, within_bounds: true, text: '', statement: [] }
  const running = fixtures.progress({ kind: 'certify', evaluations: 100, planned: 300 })
  expect(boundSoFar(running, so_far)).toContain('P within the bounds ≤ 3')
  expect(boundSoFar(running, { ...so_far, within_bounds: false })).not.toContain('within')
})

it('states of a sample that is drawn what failed, and when its later bound holds', () => {
  const so_far = { samples: 100, violations: 3, failed: 0, upper_bound: 0.08, at_end: 0.03, within_bounds: false, text: '', statement: [] }
  const running = fixtures.progress({ kind: 'certify', evaluations: 200, excluded: 100, planned: 300, left: 400, seconds: 10 })
  expect(boundSoFar(running, so_far)).toMatch(/^3 violations, P ≤ 8\s%, 3\s% in 20\.0\ss if no other violates$/)
  expect(boundSoFar(running, { ...so_far, failed: 2 })).toMatch(/^3 violate or failed \(2 failed\), P/)
})

it('counts no excluded sample as done, because it is drawn again', () => {
  const running = fixtures.progress({ kind: 'certify', title: 'Certify', state: 'running', evaluations: 300, excluded: 150, planned: 300, left: 300 })
  expect(shareOf(running)).toBe(0.5)
  expect(shareOf({ ...running, state: 'done', left: 0 })).toBe(1)
  const live = { ...RUN, state: 'running' as const, verdict: null, stages: [running], plan: [{ kind: 'certify' as const, title: 'Certify', description: '' }] }
  expect(text(renderToStaticMarkup(<StageStrip run={live} />))).toContain('300 of about 600')
})

it('marks a check green only where nothing is open', () => {
  const look = (standing: DescribedCheck['standing']) => renderToStaticMarkup(<Standing check={{ standing }} />)
  expect(look('holds')).toContain('ok-t')
  expect(look('open')).not.toContain('ok-t')
  expect(look('fails')).toContain('bad-t')
})
