// Parsing of component texts.
import { expect, it } from 'vitest'
import { partsOf } from './docstring'

const TEXT = `Unicycle: a point with a heading.

    dx/dt = v cos(theta)        dv/dt = F / m
      where v > 0

x, y [m], theta [rad];
g = 9.81 m/s2.
Source: A thesis, equations 3.1
and 3.2. Start reading at \`step\`.

side   -1 left, 1 right
gate   0 acts on every intruder`

it('distinguishes title, equations, paragraphs, sources and tables of words', () => {
  expect(partsOf(TEXT)).toEqual({
    title: 'Unicycle: a point with a heading.',
    parts: [
      { kind: 'equations', text: 'dx/dt = v cos(theta)        dv/dt = F / m\n  where v > 0' },
      { kind: 'text', text: 'x, y [m], theta [rad]; g = 9.81 m/s2.' },
      { kind: 'text', label: 'Source', text: 'A thesis, equations 3.1 and 3.2.' },
      { kind: 'table', text: 'side   -1 left, 1 right\ngate   0 acts on every intruder' },
    ],
  })
})

it('takes a single line', () => {
  expect(partsOf('None: no avoidance.')).toEqual({ title: 'None: no avoidance.', parts: [] })
  expect(partsOf('')).toEqual({ title: '', parts: [] })
})
