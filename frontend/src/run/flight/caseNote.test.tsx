// When the what-if of a simulator is evaluated, and what is said of its result.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { aboutOf, CaseNote } from './CaseNote'
import { caseOf } from './whatif'

const state = { answer: null, busy: false, follows: false, stale: true, seconds: null, evaluate: () => undefined }
const shown = (more: object) => renderToStaticMarkup(<CaseNote {...state} {...more} />)
const answer = { seconds: 4.2, untraced: '' }

it('gives times as they decide whether to wait', () => {
  expect([0.0004, 0.0123, 0.24, 4.26, 42.4, 59.96].map(aboutOf)).toEqual([
    'less than 0.001 s',
    'about 0.01 s',
    'about 0.2 s',
    'about 4 s',
    'about 42 s',
    'about 60 s',
  ])
})

it('evaluates on request, with the time once it is known', () => {
  expect(shown({})).toMatch(/<button[^>]*>.*Evaluate<\/button>/)
  expect(shown({ seconds: 4.2 })).toContain('Evaluate (about 4 s)')
  expect(shown({ seconds: 4.2, busy: true })).toMatch(/disabled.*Evaluating …/)
  expect(shown({ seconds: 0.02, follows: true })).not.toContain('<button')
  expect(shown({ seconds: 0.02, follows: true })).toContain('an evaluation takes about 0.02 s')
})

it('cannot be evaluated where the simulator is not installed, and says so before it is tried', () => {
  const html = shown({ missing: 'the machine of the service has no such simulator' })
  expect(html).toMatch(/<button[^>]*disabled/)
  expect(html).toContain('No case can be evaluated: the machine of the service has no such simulator.')
  const why = /<button[^>]*aria-describedby="([^"]+)"/.exec(html)?.[1]
  expect(html).toContain(`id="${why}"`)
  expect(shown({ missing: '' })).not.toMatch(/disabled|No case can be evaluated/)
})

it('says of which values the result is, and that it is no evidence', () => {
  expect(shown({ answer, seconds: 4.2 })).toContain('The result belongs to other values')
  expect(shown({ answer, seconds: 4.2, stale: false })).not.toContain('other values')
  expect(shown({ answer: { ...answer, untraced: 'it has 1 row' } })).toContain('No trace of it: it has 1 row.')
  expect(shown({})).toContain('is no evidence')
})

it('requests a case without a noise seed', () => {
  const whatIf = { like: 'F1', set: { 'simulator.x': 2 }, seed: 7 }
  expect(caseOf(whatIf, 'key')).toEqual({ like: 'F1', parameters: { 'simulator.x': 2 }, view: 'key', rows: 200 })
})
