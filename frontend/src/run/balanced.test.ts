// Cards in two balanced columns.
import { expect, it } from 'vitest'
import { balanced } from './balanced'

const heights = (...values: number[]) => balanced(values.map((height) => ({ height }))).map((column) => column.map(({ height }) => height))

it('ends both columns as near as can be, the first card in the first', () => {
  expect(heights(480, 260, 150, 130)).toEqual([[480], [260, 150, 130]])
  expect(heights(100, 500, 200, 190)).toEqual([[100, 200, 190], [500]])
  expect(heights(300)).toEqual([[300], []])
})
