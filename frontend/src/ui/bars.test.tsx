// The bar of a margin says what its number and the verdict say.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { MarginBar } from './bars'

it.each([
  [-1, true, 'bad'],
  [-1e-9, true, 'bad'],
  [0, true, 'bad'],
  [0, false, 'bad'],
  [1e-9, true, 'ok'],
  [1, true, 'ok'],
  [1, false, 'unk'],
])('a margin of %d, cleared: %s', (margin, cleared, tone) => {
  expect(renderToStaticMarkup(<MarginBar margin={margin} threshold={2} cleared={cleared} />)).toContain(`--${tone}-solid`)
})
