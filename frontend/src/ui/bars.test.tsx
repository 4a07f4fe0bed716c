// The bar of a margin says what its number says.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { MarginBar } from './bars'

it.each([
  [-1, false, 'bad'],
  [-1e-9, false, 'bad'],
  [0, false, 'bad'],
  [0, true, 'bad'],
  [1e-9, false, 'ok'],
  [1, false, 'ok'],
  [1, true, 'unk'],
])('a margin of %d, with failures: %s', (margin, open, tone) => {
  expect(renderToStaticMarkup(<MarginBar margin={margin} threshold={2} open={open} />)).toContain(`--${tone}-solid`)
})
