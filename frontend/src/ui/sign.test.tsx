// Names of parameters in print.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { Spans } from './Spans'
import { Sign, symbolText } from './Sign'

const text = (html: string) => html.replace(/<[^>]+>/g, '')

it('prints the symbol of a name as a symbol and its part as words', () => {
  expect(symbolText('omega_r of obstacle 1')).toBe('ω_r of obstacle 1')
  expect([symbolText('m'), symbolText('simulator.mass')]).toEqual(['m', 'simulator.mass'])
  expect(text(renderToStaticMarkup(<Sign text="omega_r of obstacle 1" path="obstacles.0.rate" />))).toBe('ωr of obstacle 1')
})

it('names a parameter in a stored sentence that printed its path', () => {
  const path = 'obstacles.1.position.y'
  const shown = renderToStaticMarkup(<Spans spans={[{ kind: 'symbol', name: path, symbol: path }]} />)
  expect(text(shown)).toBe('y of obstacle 2')
  expect(shown).toContain(`title="${path}"`)
})

it('rounds the numbers of a sentence for reading, and has all digits on hover', () => {
  const quantity = { kind: 'quantity' as const, value: 0.941741234, unit: 'm', format: 'plain' as const, digits: 6, name: '' }
  const shown = renderToStaticMarkup(<Spans spans={[quantity]} />)
  expect(text(shown)).toBe('0.9417\u202fm')
  expect(shown).toContain('title="0.941741234\u202fm"')
  expect(text(renderToStaticMarkup(<Spans spans={[quantity]} exact />))).toBe('0.941741\u202fm')
})
