// The next steps after an inconclusive verdict, and the campaign that each of them opens.
import { expect, it } from 'vitest'
import { parse } from 'yaml'
import type { Remedy } from '../../client'
import { changed, changesFor } from './remedied'
import { amended } from '../text'
import { keysOf, statementOf, stepsIn, stepsOf } from '../../api/steps'

const remedy = (text: string, ...changes: [(string | number)[], unknown][]): Remedy => ({
  kind: 'step', text, statement: [{ kind: 'text', text }], changes: changes.map(([at, value]) => ({ at, value })),
})
const STEP = remedy('with step 10 ms', [['scenario', 'step'], 0.01])
const METHOD = remedy('with CMA-ES as a further method', [['stages', 'search', 1], { method: 'cma_es', evaluations: 2000 }])
const SAMPLE = remedy('with an independent sample of 60', [['stages', 'certify'], { samples: 60 }])
const LARGER = remedy('with an independent sample of 3000', [['stages', 'certify'], { samples: 3000 }])
const CHECKS = [
  { name: 'validation', remedies: [STEP] },
  { name: 'agreement', remedies: [METHOD] },
  { name: 'closest approach', remedies: [] },
  { name: 'noise', remedies: [SAMPLE] },
  { name: 'target', remedies: [LARGER] },
]
const TEXT = `# A campaign with comments.
name: Case
scenario: {step: 0.02, horizon: 15} # coarse
stages:
  search:
    - method: direct # the first
      evaluations: 1000
`

it('offers every remedy once, by the place of its check', () => {
  expect(stepsOf(CHECKS).map(({ key }) => key)).toEqual(['validation.0', 'agreement.0', 'noise.0'])
  expect(keysOf(stepsIn('noise.0,validation.0', CHECKS))).toBe('validation.0,noise.0')
  expect(stepsIn('validation.1,x,,constructor.0', CHECKS)).toEqual([])
  expect(statementOf(stepsIn('validation.0,agreement.0', CHECKS)).map((span) => ('text' in span ? span.text : '')).join('')).toBe(
    'with step 10 ms, with CMA-ES as a further method',
  )
})

it('makes the changes in the text of the campaign, with its comments, and in its document', () => {
  const document: unknown = parse(TEXT)
  const steps = stepsIn('validation.0,agreement.0,noise.0', CHECKS)
  const text = amended(TEXT, changesFor(document, steps))
  const wanted = changed(document, steps)
  expect(parse(text)).toEqual(wanted)
  expect(wanted).toEqual({
    name: 'Case',
    scenario: { step: 0.01, horizon: 15 },
    stages: {
      search: [{ method: 'direct', evaluations: 1000 }, { method: 'cma_es', evaluations: 2000 }],
      certify: { samples: 60 },
    },
  })
  expect(text).toContain('# A campaign with comments.')
  expect(text).toContain('# the first')
})

it('sets what the text leaves to a default', () => {
  const more = [{ name: 'minimum', remedies: [remedy('', [['stages', 'findings', 'evaluations'], 80000])] }]
  const text = amended(TEXT, changesFor(parse(TEXT), stepsOf(more)))
  expect(parse(text)).toMatchObject({ stages: { findings: { evaluations: 80000 } } })
})
