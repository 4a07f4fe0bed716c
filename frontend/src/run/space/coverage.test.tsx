// The card of the coverage: its figures, its sentences, what it omits, and that it is no proof.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { coverage } from '../../../tests/fixtures'
import type { Coverage } from '../../client'
import { NONE } from '../../format/numbers'
import { words } from '../../format/spans'
import { CoverageCard } from './Coverage'

const parameter = (path: string, symbol: string, low: number, high: number) => ({ path, symbol, unit: 'kg', text: '', nominal: low, low, high })
const parameters = [parameter('vehicle.m', 'm', 4, 6), parameter('vehicle.J', 'J', 0.04, 0.06), parameter('start.v', 'v', 0, 1)]
const card = (more: Partial<Coverage> = {}) =>
  renderToStaticMarkup(<CoverageCard data={{ parameters }} coverage={coverage(more)} />).replace(/<[^>]+>/g, ' ').replace(/\s+/g, ' ')

it('shows the three figures with what they are of', () => {
  const shown = card()
  for (const text of ['0.176', 'each range is 1, the diagonal 1.41', '34 of 100 have an evaluation', '34 %', '4 %', '± 0.3 % standard error']) expect(shown).toContain(text)
})

it('states random points instead of a standard error of 0', () => {
  const of = (fraction: number) => card({ possible: { slope: 1, fraction, standard_error: 0, points: 256 } })
  expect(of(0)).toContain('none of 256 random points')
  expect(of(1)).toContain('all of 256 random points')
  expect(of(0) + of(1)).not.toContain('standard error')
})

it('shows every sentence, and in its heading that it is no proof', () => {
  const statements = [[words('All 1000 evaluations are used.')], [words('Coverage is no proof: a violation may be smaller.')]]
  const shown = card({ statements })
  const places = ['; no proof', 'All 1000 evaluations are used.', 'Coverage is no proof: a violation may be smaller.'].map((text) => shown.indexOf(text))
  expect(places.every((place) => place >= 0)).toBe(true)
  expect(places).toEqual([...places].sort((a, b) => a - b))
})

it('lists the centre in the units of the parameters that have one', () => {
  expect(card()).toContain('m 5.500 kg')
  expect(card()).toContain('J 0.04500 kg')
  expect(card()).not.toContain(' v ')
})

it('lists the least covered pairs, a few at first', () => {
  const pairs = Array.from({ length: 9 }, (_, i) => ({ first: 'vehicle.m', second: i === 0 ? 'start.v' : 'vehicle.J', touched: 10 + i }))
  const shown = card({ pairs })
  expect(shown).toContain('m and v 10')
  expect(shown).toContain('m and J 15')
  expect(shown).not.toContain('m and J 16')
  expect(shown).toContain('Show all 9')
  expect(card()).not.toContain('least covered first')
  expect(card({ pairs: pairs.map((pair) => ({ ...pair, touched: 100 })) })).not.toContain('least covered first')
})

it('has no figure where none was computed', () => {
  const shown = card({ ball: null, pairs: [], possible: null })
  expect(shown.split(NONE)).toHaveLength(4)
  for (const text of ['no evaluation', 'one parameter has no pair', 'no slope']) expect(shown).toContain(text)
  expect(shown).not.toContain('Centre')
})
