import { afterEach, beforeEach, expect, it, vi } from 'vitest'

const BASE = 'http://service'
const RUN = '/api/v1/runs/R-0001'

let sent: string[] = []
let answering: (path: string) => unknown

/** The paths of a batch. */
const pathsOf = (url: string): string[] => new URL(url, BASE).searchParams.getAll('path')
const batches = () => sent.filter((url) => url.includes('/batch?'))

beforeEach(() => {
  sent = []
  answering = (path) => ({ of: path })
  vi.resetModules()
  vi.stubGlobal('fetch', (request: string | Request) => {
    const url = typeof request === 'string' ? request : request.url.replace(BASE, '')
    sent.push(url)
    if (!url.includes('/batch?')) return Promise.resolve(Response.json({ alone: url }))
    const lines = pathsOf(url).flatMap((path) => {
      const document = answering(path)
      return document === undefined ? [] : [JSON.stringify({ path: `/api/v1${path}`, etag: `"${path}"` }), JSON.stringify(document)]
    })
    return Promise.resolve(new Response(lines.map((line) => `${line}\n`).join('')))
  })
})

afterEach(() => {
  vi.useRealTimers()
  vi.unstubAllGlobals()
})

const fresh = () => import('./ahead')
const take = async (fetchOnce: (request: Request) => Promise<Response>, path: string): Promise<unknown> =>
  JSON.parse(await (await fetchOnce(new Request(BASE + path))).text())

it('asks for what a run shows first in one request, for its evaluations in another, and once', async () => {
  const { askAhead, fetchOnce } = await fresh()
  askAhead({ pathname: '/runs/R-0001', search: '?finding=F2' })
  expect(batches()).toEqual(sent)
  const [first = '', second = ''] = sent
  expect(pathsOf(second)).toEqual(['/runs/R-0001/evaluations?max_points=2'])
  expect(pathsOf(first)).toEqual(expect.arrayContaining(['/session', '/runs/R-0001', '/runs/R-0001/traces/F2?max_points=1500']))
  const found = await fetchOnce(new Request(`${BASE}${RUN}/findings`))
  expect(found.headers.get('ETag')).toBe('"/runs/R-0001/findings"')
  expect(found.ok).toBe(true)
  expect(JSON.parse(await found.text())).toEqual({ of: '/runs/R-0001/findings' })
  expect(sent).toHaveLength(2)
  expect(await take(fetchOnce, `${RUN}/findings`)).toEqual({ alone: `${RUN}/findings` })
})

it('takes no answer that has become old', async () => {
  vi.useFakeTimers()
  const { askAhead, fetchOnce } = await fresh()
  askAhead({ pathname: '/runs', search: '' })
  expect(pathsOf(sent[0] ?? '')).toEqual(['/session', '/workers', '/runs?limit=100', '/runs/facets'])
  vi.advanceTimersByTime(16_000)
  expect(await take(fetchOnce, '/api/v1/runs?limit=100')).toEqual({ alone: '/api/v1/runs?limit=100' })
})

it.each(['refused', 'lost', 'left out'])('lets a request send itself where its answer was %s', async (how) => {
  const usual = globalThis.fetch
  vi.stubGlobal('fetch', (request: string | Request) => {
    if (typeof request !== 'string' || how === 'left out') return usual(request)
    return how === 'lost' ? Promise.reject(new TypeError('no network')) : Promise.resolve(Response.json({}, { status: 429 }))
  })
  answering = () => undefined
  const { askAhead, fetchOnce } = await fresh()
  askAhead({ pathname: '/runs/R-0001', search: '' })
  for (const part of ['findings', 'traces', 'stages']) expect(await take(fetchOnce, `${RUN}/${part}`)).toEqual({ alone: `${RUN}/${part}` })
})

it('answers nothing but GET', async () => {
  const { askAhead, fetchOnce } = await fresh()
  askAhead({ pathname: '/runs/R-0001', search: '' })
  const answer = await fetchOnce(new Request(BASE + RUN, { method: 'PATCH' }))
  expect(await answer.json()).toEqual({ alone: RUN })
})

it('asks only for what all pages need where it does not know the page', async () => {
  const { askAhead } = await fresh()
  for (const pathname of ['/compare', '/runs/other', '/help', '/runs/R-0001/flight']) askAhead({ pathname, search: '' })
  askAhead({ pathname: '/runs', search: '?q=release' })
  for (const url of sent) expect(pathsOf(url)).toEqual(['/session', '/workers'])
  expect(sent).toHaveLength(5)
})
