// Requests resolve with their data and reject with why they were refused; the tag of a run is kept for its edits.
import { afterAll, afterEach, beforeAll, expect, it, vi } from 'vitest'
import { client } from '../client/client.gen'
import { checkCampaign, editRun, getRun, submitRun, tagOf } from './calls'
import { Refusal } from './problems'

const sent: Request[] = []

const { baseUrl } = client.getConfig()
beforeAll(() => void client.setConfig({ baseUrl: 'http://service' })) // without a page there is no address to begin from
afterAll(() => void client.setConfig({ baseUrl }))

function serve(answer: () => Promise<Response>): void {
  vi.stubGlobal('fetch', (request: Request) => {
    sent.push(request)
    return answer()
  })
}

afterEach(() => {
  vi.unstubAllGlobals()
  sent.length = 0
})

const json = (body: object, init: ResponseInit = {}) => new Response(JSON.stringify(body), { ...init, headers: { 'Content-Type': 'application/json', ...init.headers } })

it('keeps the tag of a run that was read or edited', async () => {
  serve(() => Promise.resolve(json({ id: 'R-0041' }, { headers: { ETag: '"1"' } })))
  expect(await getRun('R-0041')).toEqual({ id: 'R-0041' })
  expect(tagOf('R-0041')).toBe('"1"')
  serve(() => Promise.resolve(json({ id: 'R-0041' }, { headers: { ETag: '"2"' } })))
  await editRun('R-0041', { name: 'other' }, tagOf('R-0041'))
  expect(sent[1]?.headers.get('If-Match')).toBe('"1"')
  expect(tagOf('R-0041')).toBe('"2"')
  serve(() => Promise.resolve(json({ title: 'Precondition Failed', detail: 'it was changed' }, { status: 412, headers: { ETag: '"3"' } })))
  await expect(editRun('R-0041', { name: 'third' }, '"2"')).rejects.toThrow('It was changed.')
  expect(tagOf('R-0041')).toBe('"2"')
})

it.each([
  ['a problem document', () => Promise.resolve(json({ title: 'Not Found', detail: 'no such run' }, { status: 404 })), 404, 'No such run.'],
  ['an empty answer', () => Promise.resolve(new Response(null, { status: 500 })), 500, 'Answer 500.'],
  ['no connection', () => Promise.reject(new TypeError('Failed to fetch')), 0, 'No response from this address.'],
])('rejects with the refusal of %s', async (_, answer, status, message) => {
  serve(answer)
  const refusal: unknown = await getRun('R-0042').catch((error: unknown) => error)
  expect(refusal).toBeInstanceOf(Refusal)
  expect(refusal).toMatchObject({ status })
  expect((refusal as Refusal).message).toContain(message)
})

it('sends documents as JSON and text as it is', async () => {
  serve(() => Promise.resolve(json({ ok: true })))
  await checkCampaign('name: a # text\n')
  await checkCampaign({ name: 'a' } as never)
  await submitRun({ campaign: { name: 'a' }, text: 'name: a' }, 'key')
  expect(sent.map(({ method, url, headers }) => [method, new URL(url).pathname, headers.get('Content-Type'), headers.get('Idempotency-Key')])).toEqual([
    ['POST', '/api/v1/campaigns/check', 'application/yaml', null],
    ['POST', '/api/v1/campaigns/check', 'application/json', null],
    ['POST', '/api/v1/runs', 'application/json', 'key'],
  ])
  expect(await Promise.all(sent.map((request) => request.text()))).toEqual(['name: a # text\n', '{"campaign":{"name":"a"}}', '{"campaign":{"name":"a"},"text":"name: a"}'])
})
