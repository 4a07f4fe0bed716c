// Clauses as sentences.
import { expect, it } from 'vitest'
import type { Span } from '../client'
import { sentence, words } from './spans'

const D_MIN: Span = { kind: 'symbol', name: 'd_min', symbol: 'd_min' }

it('gives a clause a capital and a full stop, and a symbol none', () => {
  expect(sentence([words('half the step agrees for '), D_MIN])).toEqual([words('Half the step agrees for '), D_MIN, words('.')])
  expect(sentence([D_MIN, words(' varies')])).toEqual([D_MIN, words(' varies'), words('.')])
  expect(sentence([words('It ended.')])).toEqual([words('It ended.')])
  expect(sentence([])).toEqual([])
})
