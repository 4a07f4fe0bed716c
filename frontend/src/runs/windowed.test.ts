// Which rows are in the page.
import { expect, it } from 'vitest'
import { rangeOf } from './windowed'

it('has few rows wherever the list is scrolled to, and always those in the window', () => {
  for (const scrolled of [-300, 0, 1, 5000, 449_000, 450_000, 1e7]) {
    const { first, end } = rangeOf(-scrolled, 900, 45, 10_000)
    expect(end - first).toBeLessThan(64)
    expect(first).toBeLessThanOrEqual(end)
    const [top, bottom] = [Math.floor(scrolled / 45), Math.ceil((scrolled + 900) / 45)]
    for (const row of [top, bottom - 1])
      if (row >= 0 && row < 10_000) expect(row >= first && row < end).toBe(true)
  }
})

it('has all rows of a short list', () => {
  expect(rangeOf(200, 900, 45, 3)).toEqual({ first: 0, end: 3 })
  expect(rangeOf(200, 900, 45, 0)).toEqual({ first: 0, end: 0 })
})
