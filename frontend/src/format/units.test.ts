// Units as they are written in titles.
import { expect, it } from 'vitest'
import { ofUnit } from './units'

it('leaves no comma where a quantity has no unit', () => {
  expect(ofUnit('m/s')).toBe(', m/s')
  expect(ofUnit('')).toBe('')
})
