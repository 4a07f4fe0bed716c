// Evaluations without a value are reported consistently next to every count, margin and check.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { asCampaign } from '../api/campaign'
import * as fixtures from '../../tests/fixtures'
import type { DescribedCheck, Outcome, RunDetail, StageProgress } from '../client'
import { withoutValue } from '../format/counts'
import { COLUMNS } from '../runs/columns'
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
const figures = (run: RunDetail) => renderToStaticMarkup(<FiveFigures data={{ run, campaign: asCampaign(run.campaign), findings: [] }} />)
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
  expect(cell('margin', whole)).toContain('--ok-solid')
})

it('names a random search as the source of a bound in list, figures and tables', () => {
  const by = (source: 'certify' | 'search'): RunDetail => {
    const summary = RUN.summary && { ...RUN.summary, statistics: RUN.summary.statistics && { ...RUN.summary.statistics, source } }
    return { ...RUN, summary, bound_source: source }
  }
  for (const [source, named] of [['certify', false], ['search', true]] as const) {
    expect(text(cell('bound', by(source))).includes('random search')).toBe(named)
    expect(text(figures(by(source))).includes('random search')).toBe(named)
    expect(boundOf({ upper_bound: 0.01, bound_source: source } as Outcome).includes('random search')).toBe(named)
  }
})

it('writes within the bounds where what is beyond them is not known', () => {
  const so_far = { samples: 100, violations: 0, upper_bound: 0.03, at_end: 0.01, within_bounds: true, text: '', statement: [] }
  const running = fixtures.progress({ kind: 'certify', evaluations: 100, planned: 300 })
  expect(boundSoFar(running, so_far)).toContain('P within the bounds ≤ 3')
  expect(boundSoFar(running, { ...so_far, within_bounds: false })).not.toContain('within')
})

it('marks a check green only where nothing is open', () => {
  const look = (standing: DescribedCheck['standing']) => renderToStaticMarkup(<Standing check={{ standing }} />)
  expect(look('holds')).toContain('ok-t')
  expect(look('open')).not.toContain('ok-t')
  expect(look('fails')).toContain('bad-t')
})
