// Quantities have the same digits as those of the service.
import { expect, it } from 'vitest'
import type { Quantity } from '../client'
import table from './quantities.json'
import { quantityText } from './quantity'

it('writes every quantity of the table as the service does', () => {
  expect(table.length).toBeGreaterThan(100)
  const rows = table as (Pick<Quantity, 'value' | 'unit' | 'format' | 'digits'> & { text: string })[]
  expect(rows.map(quantityText)).toEqual(rows.map((row) => row.text))
})
