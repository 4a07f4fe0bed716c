// The compare page counts evaluations without a value in the same way as the page of each run.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { violatedOf } from '../format/counts'
import type { Compared } from './data'
import { Results } from './Results'

const compared = (letter: string, failed: number, excluded: number) =>
  ({
    ...{ id: `R-${letter}`, letter, dash: [], findings: [], parameters: [] },
    stages: [],
    run: {
      ...{ id: `R-${letter}`, state: 'done', verdict: 'inconclusive', quantity: 'd_min', unit: 'm', threshold: 0.5 },
      ...{ worst_cost: 0.4, nominal_cost: 0.6, margin: -0.1, evaluations: 1371, summary: {} },
      ...{ failed_evaluations: failed, excluded_evaluations: excluded },
    },
  }) as unknown as Compared
const RUNS = [compared('A', 0, 0), compared('B', 12, 25)]

const text = (html: string) => html.replace(/<[^>]+>/g, '|').replaceAll('\u202f', ' ')
const row = (name: string) => {
  const found = renderToStaticMarkup(<Results runs={RUNS} className="" />).match(new RegExp(`<tr data-row="${name}">.*?</tr>`))
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
