// A service that does not answer is reported after 3 s, whichever way it was noticed, and no longer once it answers.
import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { PATIENCE, Pulse, troubleOf } from './pulse'

const PROBLEM = { 'Content-Type': 'application/problem+json' }

beforeEach(() => {
  vi.useFakeTimers({ now: 1_000_000 })
})
afterEach(() => {
  vi.useRealTimers()
})

/** A service that hangs, refuses connections, leaves the answer to a proxy, or answers, as told. */
class Service {
  state: 'hangs' | 'refuses' | 'behind a proxy' | 'answers' = 'answers'
  requests = 0
  private waiting: (() => void)[] = []

  /** Why it can do nothing, in its answer. */
  trouble = ''

  readonly ask = (signal: AbortSignal): Promise<string | void | null> => {
    this.requests++
    if (this.state === 'behind a proxy') return Promise.resolve(null)
    if (this.trouble) return Promise.resolve(this.trouble)
    if (this.state === 'refuses') return Promise.reject(new TypeError('Failed to fetch'))
    if (this.state === 'answers') return Promise.resolve()
    return new Promise((resolve, reject) => {
      this.waiting.push(resolve)
      signal.addEventListener('abort', () => reject(new DOMException('', 'AbortError')))
    })
  }

  wakes(): void {
    this.state = 'answers'
    for (const answer of this.waiting.splice(0)) answer()
  }
}

const made = (state: Service['state']): [Service, Pulse] => {
  const service = new Service()
  service.state = state
  return [service, new Pulse(service.ask)]
}

/** So many seconds, with a tick at the start of each. */
async function seconds(number: number, pulse: Pulse): Promise<void> {
  for (let i = 0; i < number; i++) {
    pulse.tick()
    await vi.advanceTimersByTimeAsync(1000)
  }
}

it('reports a request without an answer after 3 s, and takes it back', async () => {
  const [service, pulse] = made('hangs')
  const request = pulse.follow(new Promise(() => undefined))
  await vi.advanceTimersByTimeAsync(PATIENCE - 1)
  expect(pulse.contact.get().state).toBe('well')
  await vi.advanceTimersByTimeAsync(1)
  expect(pulse.contact.get()).toEqual({ state: 'silent', since: 1_000_000 })
  service.wakes()
  await vi.advanceTimersByTimeAsync(0)
  expect(pulse.contact.get().state).toBe('well')
  void request
})

it('says nothing of a request that takes long while the service answers others', async () => {
  const [, pulse] = made('answers')
  void pulse.follow(new Promise(() => undefined))
  for (let i = 0; i < 60; i++) {
    await vi.advanceTimersByTimeAsync(1000)
    pulse.tick()
    expect(pulse.contact.get().state).toBe('well')
  }
})

it('asks on a quiet page, and goes on asking until there is an answer', async () => {
  const [service, pulse] = made('hangs')
  await seconds(8, pulse)
  expect(pulse.contact.get().state).toBe('silent')
  await seconds(30, pulse)
  expect(service.requests).toBeGreaterThan(2)
  service.wakes()
  await vi.advanceTimersByTimeAsync(0)
  expect(pulse.contact.get().state).toBe('well')
})

it('distinguishes a service that is not there, with a pause between the questions', async () => {
  const [service, pulse] = made('refuses')
  await seconds(12, pulse)
  expect(pulse.contact.get().state).toBe('unreachable')
  expect(service.requests).toBeLessThan(7)
  service.state = 'answers'
  await seconds(3, pulse)
  expect(pulse.contact.get().state).toBe('well')
})

it('asks nothing while answers come', async () => {
  const [service, pulse] = made('answers')
  for (let i = 0; i < 20; i++) {
    await pulse.follow(Promise.resolve())
    pulse.tick()
    await vi.advanceTimersByTimeAsync(1000)
  }
  expect(service.requests).toBe(0)
})

it('reports a service that can do nothing with its sentence, until the health check succeeds', async () => {
  const [service, pulse] = made('answers')
  service.trouble = 'the database cannot be reached'
  await pulse.follow(Promise.resolve(new Response(null, { status: 503, headers: PROBLEM })))
  await vi.advanceTimersByTimeAsync(0)
  expect(pulse.contact.get()).toEqual({ state: 'unusable', since: 1_000_000, why: 'the database cannot be reached' })
  await pulse.follow(Promise.resolve(new Response(null, { status: 200 })))
  expect(pulse.contact.get().state).toBe('unusable')
  service.trouble = ''
  pulse.tick()
  await vi.advanceTimersByTimeAsync(0)
  expect(pulse.contact.get().state).toBe('well')
})

it('takes the answer of a proxy for silence, and asks again after a pause until the service answers', async () => {
  const [service, pulse] = made('behind a proxy')
  await pulse.follow(Promise.resolve(new Response('<html>', { status: 502, headers: { 'Content-Type': 'text/html' } })))
  await vi.advanceTimersByTimeAsync(0)
  expect(pulse.contact.get()).toEqual({ state: 'silent', since: 1_000_000 })
  for (let i = 0; i < 6; i++) {
    pulse.tick()
    await pulse.follow(Promise.resolve(new Response('<html>', { status: 504 })))
    await vi.advanceTimersByTimeAsync(1000)
    expect(pulse.contact.get().state).toBe('silent')
  }
  expect(service.requests).toBeLessThan(6)
  service.state = 'answers'
  await seconds(2, pulse)
  expect(pulse.contact.get().state).toBe('well')
})

it('believes the service rather than one request that a proxy gave up', async () => {
  const [, pulse] = made('answers')
  await pulse.follow(Promise.resolve(new Response(null, { status: 504 })))
  await vi.advanceTimersByTimeAsync(0)
  expect(pulse.contact.get().state).toBe('well')
})

it('reads the sentence of a problem document, and nothing of a service that is busy', () => {
  const type = 'urn:clearance:problem:'
  expect(troubleOf(JSON.stringify({ type: `${type}damaged`, detail: 'it is damaged' }))).toBe('it is damaged')
  expect(troubleOf(JSON.stringify({ type: `${type}busy`, detail: 'try again' }))).toBe('')
  expect(troubleOf('<html>')).toBe('')
})
