// A run without a verdict that found a value at or below the threshold: its banner states the value, and not that nothing is known.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { run } from '../../../tests/fixtures'
import type { RunDetail } from '../../client'
import { WithoutVerdict } from './Banner'

const number = (value: number) => ({ kind: 'quantity' as const, value, unit: 'm', format: 'plain' as const, digits: 12, name: '' })
const sentence = [{ kind: 'text' as const, text: 'The lowest value found is ' }, number(0.4999999999)]
const shown = (state: 'cancelled' | 'failed', unconfirmed: RunDetail['unconfirmed']) => {
  const of = run({ state, verdict: null, evaluations: 12, error: 'the worker was lost', unconfirmed })
  return renderToStaticMarkup(<WithoutVerdict run={of} outcome={state} />).replace(/<[^>]+>/g, '')
}

it.each(['cancelled', 'failed'] as const)('states the value of a %s run on its side of the threshold', (state) => {
  expect(shown(state, sentence)).toContain('The lowest value found is 0.4999999999')
  expect(shown(state, sentence)).not.toContain('about the avoidance system')
  expect(shown(state, [])).toContain('about the avoidance system')
})
