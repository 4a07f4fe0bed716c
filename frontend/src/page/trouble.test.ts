// A page whose data cannot be read again keeps what it shows, and what was typed into it.
import { readdirSync, readFileSync } from 'node:fs'
import { join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { expect, it } from 'vitest'

const SRC = fileURLToPath(new URL('..', import.meta.url))
/** An error in place of the page although there may be data: a refetch in the background that failed. */
const REPLACED = /isError\)\s*(return|\?)\s*<Trouble|\.find\(\((\w+)\) => \2\.isError\)/

it('no page is replaced by an error while it has data', () => {
  const pages = readdirSync(SRC, { recursive: true, encoding: 'utf8' }).filter((path) => path.endsWith('.tsx'))
  expect(pages.length).toBeGreaterThan(100)
  expect(pages.filter((path) => REPLACED.test(readFileSync(join(SRC, path), 'utf8')))).toEqual([])
})

it('sees such a page', () => {
  expect('if (query.isError) return <Trouble error={query.error} />').toMatch(REPLACED)
  expect('asks.find((query) => query.isError)').toMatch(REPLACED)
  expect('if (query.isError && !query.data) return <Trouble error={query.error} />').not.toMatch(REPLACED)
})
