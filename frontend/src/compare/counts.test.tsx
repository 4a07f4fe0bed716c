// The compare page counts evaluations without a value in the same way as the page of each run.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { violatedOf } from '../format/counts'
import { gravest } from './Change'
import type { Compared } from './data'
import { Results } from './Results'

const compared = (letter: string, failed: number, excluded: number) =>
  ({
    ...{ id: `R-${letter}`, letter, dash: [], findings: [], parameters: [], parts: {} },
    stages: [],
    run: {
      ...{ id: `R-${letter}`, state: 'done', verdict: 'inconclusive', quantity: 'd_min', unit: 'm', threshold: 0.5 },
      ...{ worst_cost: 0.4, nominal_cost: 0.6, margin: -0.1, evaluations: 1371, summary: {} },
      ...{ failed_evaluations: failed, excluded_evaluations: excluded },
    },
  }) as unknown as Compared
const RUNS = [compared('A', 0, 0), compared('B', 12, 25)]

const text = (html: string) => html.replace(/<[^>]+>/g, '|').replaceAll('\u202f', ' ')
const row = (name: string, runs = RUNS) => {
  const found = renderToStaticMarkup(<Results runs={runs} />).match(new RegExp(`<tr data-row="${name}">.*?</tr>`))
  return text(found?.[0] ?? '').split('|').map((part) => part.trim()).filter(Boolean)
}

it('shows what failed and what was excluded, each by itself', () => {
  expect(row('evaluations')).toEqual(['Evaluations', '1 371', '1 371', '0'])
  expect(row('failed')).toEqual(['Failed', '0', '12', '+12'])
  expect(row('excluded')).toEqual(['Excluded', '0', '25', '+25'])
})

it('states how many evaluations of a sample failed and how many draws were excluded', () => {
  expect(violatedOf({ samples: 300, violations: 4, failed: 0, excluded: 0 })).toBe('4 of 300 samples violate')
  const lossy = { samples: 300, violations: 4, failed: 4, excluded: 20 }
  expect(violatedOf(lossy)).toBe('4 of 300 samples failed and count as violations; 20 draws excluded')
})

const bounded = (letter: string, upper_bound: number, confidence: number, margin: number) => {
  const one = compared(letter, 0, 0)
  const statistics = { samples: 3000, violations: 0, upper_bound, confidence }
  return { ...one, run: { ...one.run, margin, upper_bound, summary: { statistics } } } as unknown as Compared
}

it('writes no bound below itself, no margin as zero, and a confidence only if all runs share it', () => {
  const runs = [bounded('A', 0.02, 0.95, -4e-5), bounded('B', 3.00001e-6, 0.995, 1)]
  expect(row('bound', runs).slice(0, 3)).toEqual(['P(violation), bound', '2 %', '3.01e−6'])
  expect(row('margin', runs)).toContain('−4e−5')
  expect(row('bound', [bounded('A', 0.02, 0.995, 1), bounded('B', 0.01, 0.995, 1)])).toEqual(['P(violation), 99.5 % bound', '2 %', '1 %', '−1 %'])
})

it('names a random search as the source of a bound', () => {
  const [one, other] = [bounded('A', 0.02, 0.95, 1), bounded('B', 0.01, 0.95, 1)]
  other.run.bound_source = 'search'
  expect(row('bound', [one, other]).slice(1)).toEqual(['2 %', '1 %', 'random search', '−1 %'])
})

it('calls what has no symbol the value', () => {
  const one = compared('A', 0, 0)
  one.run.quantity = ''
  expect(row('worst', [one])).toEqual(['Worst', 'value', 'm', '0.4000'])
})

it('several runs together are no better than the gravest of them', () => {
  expect(gravest(['cleared', 'failed', 'inconclusive'])).toBe('failed')
  expect(gravest(['cleared', 'inconclusive'])).toBe('inconclusive')
  expect(gravest(['running', 'violated', 'cleared'])).toBe('violated')
  expect(gravest(['cleared', 'cleared', 'cleared'])).toBe('cleared')
})
