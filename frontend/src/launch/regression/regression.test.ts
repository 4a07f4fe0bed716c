import { expect, test } from 'vitest'
import { baselineProblem, labelsOf, textsOf } from './regression'

test('labels are read as on the command line', () => {
  expect(labelsOf(['branch=main', ' commit = 4f2a91c ', 'note=a=b, c'])).toEqual({
    labels: { branch: 'main', commit: '4f2a91c', note: 'a=b, c' },
  })
  expect(labelsOf([])).toEqual({ labels: {} })
  expect(textsOf({ branch: 'main', note: 'a=b' })).toEqual(['branch=main', 'note=a=b'])
})

test.each([
  [['main'], 'KEY=VALUE'],
  [['=main'], 'KEY=VALUE'],
  [['branch='], 'KEY=VALUE'],
  [['branch= '], 'KEY=VALUE'],
  [['1st=a'], 'cannot be a key'],
  [['zweig ä=a'], 'cannot be a key'],
  [['branch=a', 'branch=b'], 'given twice'],
  [Array.from({ length: 21 }, (_, i) => `k${i}=v`), 'at most 20'],
])('refuses %j with a sentence', (texts, problem) => {
  expect(labelsOf(texts)).toEqual({ problem: expect.stringContaining(problem) as string })
})

test('a key named like a part of every object is a label as any other', () => {
  expect(labelsOf(['constructor=a', 'toString=b'])).toEqual({ labels: { constructor: 'a', toString: 'b' } })
})

test('a baseline is a run or the newest one with a label', () => {
  for (const text of ['', '  ', 'R-0001', 'R-12', ' R-0001 ', 'label:branch=main']) expect(baselineProblem(text), text).toBe('')
  for (const text of ['main', 'branch=main', 'R-', 'r-12', 'S-0001', 'label:', 'label:main', 'label:=x'])
    expect(baselineProblem(text), text).toMatch(/\.$/)
})
