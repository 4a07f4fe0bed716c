import { afterEach, beforeEach, expect, it, vi } from 'vitest'

const BASE = 'http://service'
const RUN = '/api/v1/runs/R-0001'

let sent: string[] = []
let ended: string[] = []

beforeEach(() => {
  sent = []
  ended = []
  vi.resetModules()
  vi.stubGlobal('document', { fonts: { load: () => Promise.resolve([]) } })
  vi.stubGlobal('fetch', (request: string | Request, init?: RequestInit) => {
    const url = typeof request === 'string' ? request : request.url.replace(BASE, '')
    sent.push(url)
    init?.signal?.addEventListener('abort', () => ended.push(url))
    return Promise.resolve(Response.json(url.endsWith('/traces') ? [{ name: 'nominal' }, { name: 'F1' }, { name: 'F2' }] : url))
  })
})

afterEach(() => {
  vi.useRealTimers()
  vi.unstubAllGlobals()
})

const fresh = () => import('./ahead')

it('asks for what a run shows first, and once', async () => {
  const { askAhead, fetchOnce } = await fresh()
  askAhead({ pathname: '/runs/R-0001', search: '?finding=F2' })
  await vi.waitFor(() => expect(sent).toContain(`${RUN}/evaluations?max_points=2000`))
  expect(sent).toContain(`${RUN}/traces/F2?max_points=1500`)
  expect(sent).not.toContain(`${RUN}/traces/F1?max_points=1500`)
  const before = sent.length
  const take = async (path: string): Promise<unknown> => (await fetchOnce(new Request(BASE + path))).json()
  expect(await take(`${RUN}/findings`)).toBe(`${RUN}/findings`)
  expect(await take(`${RUN}/traces`)).toHaveLength(3)
  expect(sent).toHaveLength(before)
  await take(`${RUN}/findings`)
  expect(sent).toHaveLength(before + 1)
})

it('takes no answer that has become old, and lets its connection go', async () => {
  vi.useFakeTimers()
  const { askAhead, fetchOnce } = await fresh()
  askAhead({ pathname: '/runs', search: '' })
  expect(sent).toEqual(['/api/v1/session', '/api/v1/runs?limit=100'])
  vi.advanceTimersByTime(16_000)
  expect(ended).toEqual(['/api/v1/session', '/api/v1/runs?limit=100'])
  await fetchOnce(new Request(`${BASE}/api/v1/runs?limit=100`))
  expect(sent).toHaveLength(3)
})

it.each(['refused', 'lost'])('gives a request that was %s only to who waits for it', async (how) => {
  let fails = true
  const { fetch } = globalThis
  vi.stubGlobal('fetch', (request: string | Request) => {
    if (!fails) return fetch(request)
    sent.push(typeof request === 'string' ? request : request.url)
    return how === 'lost' ? Promise.reject(new TypeError('no network')) : Promise.resolve(Response.json({}, { status: 422 }))
  })
  const { askAhead, fetchOnce } = await fresh()
  askAhead({ pathname: '/runs/R-0001', search: '' })
  const take = async (path: string) => (await fetchOnce(new Request(BASE + path))).status
  const waiting = take(`${RUN}/findings`)
  if (how === 'lost') await expect(waiting).rejects.toThrow('no network')
  else expect(await waiting).toBe(422)
  await new Promise((settled) => setTimeout(settled))
  fails = false
  const before = sent.length
  for (const part of ['findings', 'traces', 'stages']) expect(await take(`${RUN}/${part}`)).toBe(200)
  expect(sent).toHaveLength(before + 3)
})

it('asks for nothing more once the page asks for itself', async () => {
  const { askAhead, fetchOnce } = await fresh()
  await fetchOnce(new Request(`${BASE}${RUN}`))
  askAhead({ pathname: '/runs/R-0001', search: '' })
  expect(sent).toEqual([RUN])
})

it('asks for nothing ahead on other pages', async () => {
  const { askAhead } = await fresh()
  for (const pathname of ['/launch', '/runs/other', '/help']) askAhead({ pathname, search: '' })
  askAhead({ pathname: '/runs', search: '?q=release' })
  expect(sent).toEqual([])
})
