// Searches of the guides and the API that a new user makes: each finds the section that answers it.
import { readdirSync, readFileSync } from 'node:fs'
import { fileURLToPath } from 'node:url'
import { expect, it } from 'vitest'
import type { OpenApi } from '../docs/openapi'
import { operationsIn, passagesWith, sectionsIn } from './passages'

const of = (path: string): string => fileURLToPath(new URL(`../../../${path}`, import.meta.url))
const files = Object.fromEntries(
  readdirSync(of('docs')).filter((file) => file.endsWith('.md')).map((file) => [`../docs/${file}`, readFileSync(of(`docs/${file}`), 'utf8')]),
)
const sections = sectionsIn(files)
const operations = operationsIn(JSON.parse(readFileSync(of('frontend/openapi.json'), 'utf8')) as OpenApi)

it.each([
  ['webhook', '/help/guides/operation#webhooks'],
  ['retries', '/help/guides/your-own-simulator#does-it-repeat'],
  ['exit codes', '/help/guides/ci#exit-codes'],
  ['baseline', '/help/guides/ci#regression-between-versions'],
  ['idempotency key', '/help/guides/ci#the-rest-api'],
  ['backup', '/help/guides/operation#back-up'],
  ['junit', '/help/guides/ci#the-files-of-a-job'],
  ['sign off', '/help/guides/requirements#from-a-requirement-to-evidence'],
  ['notebook progress', '/help/guides/python#what-a-search-does'],
  ['CLEARANCE_COMPONENTS', '/help/guides/your-own-component#the-first-steps'],
])('the guides answer %s', (text, to) => {
  expect(passagesWith(sections, text).map((place) => place.to)).toContain(to)
})

it('finds operations of the API by path and description', () => {
  expect(passagesWith(operations, 'webhooks').map(({ name }) => name)).toContain('GET /webhooks')
  expect(passagesWith(operations, 'cancel run').map(({ name }) => name)).toContain('POST /runs/{run}/cancel')
})

it('names first what is found in a heading, and shows the words that were found', () => {
  const [first] = passagesWith(sections, 'exit codes')
  expect(first?.to).toBe('/help/guides/ci#exit-codes')
  for (const { note } of passagesWith(sections, 'heartbeat')) expect(note).toMatch(/heartbeat/i)
})

it('finds nothing where a word is missing, and for no text', () => {
  expect(passagesWith(sections, 'webhook zzzz')).toEqual([])
  expect(passagesWith(sections, ' ')).toEqual([])
  expect(passagesWith(sections, 'a(b[')).toEqual([])
})

it('takes no comment of code for a heading', () => {
  const one = sectionsIn({ '/ci.md': '# Continuous integration\nintro\n```sh\n# no heading\n```\n## Own\ntext\n' })
  expect(one.map(({ to }) => to)).toEqual(['/help/guides/ci', '/help/guides/ci#own'])
})
