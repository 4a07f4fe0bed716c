// Every bound and every confidence on a page is written by the functions that do not round it to the better side.
import { readdirSync, readFileSync } from 'node:fs'
import { join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { expect, it } from 'vitest'

const SRC = fileURLToPath(new URL('..', import.meta.url))
const FILES = readdirSync(SRC, { recursive: true, encoding: 'utf8' }).filter(
  (path) => /\.tsx?$/.test(path) && !/\.test\.|^client|^generated/.test(path),
)
const NEAREST = /\b(?:percent|probability|plain|fixed|written)\([^()]*(?:upper_bound|at_end|[Tt]arget|[Cc]onfidence)\w*(?:\[\d\])?\s*[,)]/

it.each(['percent(statistics.confidence)', 'percent(confidences[0])', 'probability(target, 4)', 'plain(outcome.upper_bound)'])('finds %s', (text) => {
  expect(NEAREST.test(text)).toBe(true)
})

it('rounds no bound, no target and no confidence to the nearest', () => {
  expect(FILES.length).toBeGreaterThan(200)
  const found = FILES.filter((path) => path !== join('format', 'numbers.ts') && NEAREST.test(readFileSync(join(SRC, path), 'utf8')))
  expect(found).toEqual([])
})
