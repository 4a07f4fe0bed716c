// The card of a region of attraction: the section of two states with its simulated ends, its statement, or why there is none.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import type { AttractionOfResult } from '../../api/stages'
import { words } from '../../format/spans'
import { AttractionCard } from './AttractionCard'
import { outline } from './outline'

const state = (name: string, trim: number, reach: number) => ({ name, symbol: name, unit: 'm/s', trim, limit: null, reach })
const TEXT = 'proved for the polynomial model of degree 2 about trim (speed 0.8 m/s), not for the loop as flown'
const RESULT: AttractionOfResult = {
  stage: 'attraction', text: TEXT, statement: [words(TEXT)],
  states: [state('u', 0.8, 0.5), state('v', 0, 2), state('w', 0, 1)],
  held: [], flow: [], degree: 2, fraction: 0.1, simulated: [1, 2], contradicting: 0, difference: 1e-16,
  sections: [
    { states: [0, 1], proved: [1, 1, 1, 1], simulated: [1.5, null] },
    { states: [0, 2], proved: [1, 1, 1, 1], simulated: [1.5, 2] },
  ],
}
const html = (more: Partial<AttractionOfResult> = {}) => renderToStaticMarkup(<AttractionCard result={{ ...RESULT, ...more }} />)

it('draws the boundary about the trim in the units of the states', () => {
  const [x, y] = [state('u', 0.8, 0.5), state('v', 0, 2)]
  const points = outline([1, null, 2, 1], x, y)
  expect(points.map(([a, b]) => [Number(a.toFixed(9)), Math.abs(Number(b.toFixed(9)))])).toEqual([[1.3, 0], [-0.2, 0], [0.8, 2]])
})

it('shows the section, one dot for every end of a simulation, and what is proved of what', () => {
  const shown = html()
  expect(shown).toContain('Section of u, m/s and v, m/s')
  expect(shown.match(/<circle[^>]*r="3" fill="var\(--c-nom\)"/g)).toHaveLength(2)
  expect(shown).toContain('u and w</option>')
  expect(shown).toContain('not for the loop as flown')
})

it('states why there is no region, without a drawing', () => {
  const shown = html({ sections: [], statement: [words('no region of attraction is stated: the solver is not installed')] })
  expect(shown).toContain('the solver is not installed')
  expect(shown).not.toContain('Section of')
})
