// What the button that retries a run says of its evaluations.
import { expect, it } from 'vitest'
import { retryWords } from './Retry'

it.each([
  [0, 0, 0, false],
  [15, 15, 0, false],
  [15, 12, 3, false],
  [15, 12, 2, true],
])('of %i evaluations, %i failed and %i excluded, are kept: %s', (evaluations, failed, excluded, kept) => {
  const words = retryWords({ evaluations, failed_evaluations: failed, excluded_evaluations: excluded })
  expect(words.includes('keep')).toBe(kept)
})
