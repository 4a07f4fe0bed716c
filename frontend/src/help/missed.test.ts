// The probability that a sample misses a set of violations.
import { expect, it } from 'vitest'
import { missed, SAMPLES, SLITS } from './missed'

it('is (1 - p)^n', () => {
  for (const p of SLITS) for (const n of SAMPLES) expect(missed(p, n)).toBeCloseTo((1 - p) ** n, 9)
  expect(missed(1e-3, 3000)).toBeCloseTo(0.0497, 4)
  expect(missed(1e-5, 1000)).toBeCloseTo(0.99, 3)
})
