// An event stream is opened again after whatever ended it, and what it did not tell is read.
import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { Feed } from './feed'
import { pulse } from './pulse'

/** The browser's: the tests open, break and refuse it. */
class Source extends EventTarget {
  static readonly CLOSED = 2
  static made: Source[] = []
  readyState = 0

  constructor(readonly address: string) {
    super()
    Source.made.push(this)
  }

  close(): void {
    this.readyState = Source.CLOSED
  }

  tells(name: string, data = ''): void {
    this.readyState = 1
    this.dispatchEvent(new MessageEvent(name, { data }))
  }

  /** The connection is lost; the browser opens another one. */
  breaks(): void {
    this.readyState = 0
    this.dispatchEvent(new Event('error'))
  }

  /** The answer is not 200. */
  refuses(): void {
    this.readyState = Source.CLOSED
    this.dispatchEvent(new Event('error'))
  }
}

beforeEach(() => {
  vi.useFakeTimers({ now: 1_000_000 })
  vi.stubGlobal('EventSource', Source)
  Source.made = []
})
afterEach(() => {
  pulse.contact.set({ state: 'well' })
  vi.unstubAllGlobals()
  vi.useRealTimers()
})

function made() {
  const [states, heard]: [boolean[], string[]] = [[], []]
  const missed = vi.fn()
  const feed = new Feed('/events', { run: (data) => heard.push(data) }, { open: (open) => states.push(open), missed })
  const source = () => Source.made.at(-1) as Source
  /** Time passes [s]. */
  const pass = (seconds: number) => {
    for (let i = 0; i < seconds * 4; i++) {
      vi.advanceTimersByTime(250)
      feed.tick()
    }
  }
  return { feed, source, states, heard, missed, pass }
}

it('is open by its first event', () => {
  const { source, states, heard, missed } = made()
  source().dispatchEvent(new Event('open'))
  expect(states).toEqual([false])
  source().tells('run', 'a')
  expect([states.at(-1), heard]).toEqual([true, ['a']])
  expect(missed).not.toHaveBeenCalled()
})

it('leaves a lost connection to the browser', () => {
  const { source, states, missed, pass } = made()
  source().tells('run')
  source().breaks()
  expect(states.at(-1)).toBe(false)
  pass(30)
  source().tells('beat')
  expect(states.at(-1)).toBe(true)
  expect(Source.made).toHaveLength(1)
  expect(missed).not.toHaveBeenCalled()
})

it('asks again after 2, 4, 8, 16, and every 30 s where it was refused', () => {
  const { source, missed, pass } = made()
  for (const [i, pause] of [2, 4, 8, 16, 30, 30].entries()) {
    source().refuses()
    pass(pause - 0.25)
    expect(Source.made).toHaveLength(i + 1)
    pass(0.25)
    expect(Source.made).toHaveLength(i + 2)
  }
  expect(missed).not.toHaveBeenCalled()
  source().tells('beat')
  expect(missed).toHaveBeenCalledOnce()
  source().tells('beat')
  expect(missed).toHaveBeenCalledOnce()
  source().refuses()
  pass(2)
  expect(Source.made).toHaveLength(8)
})

it('asks at once when the service answers again', () => {
  const { source, pass } = made()
  for (const pause of [2, 4, 8, 16]) {
    source().refuses()
    pass(pause)
  }
  pulse.contact.set({ state: 'silent', since: 0 })
  source().refuses()
  pass(1)
  expect(Source.made).toHaveLength(5)
  pulse.contact.set({ state: 'well' })
  pass(0.25)
  expect(Source.made).toHaveLength(6)
})

it('keeps a stream that was not refused when the service answers again', () => {
  const { source, pass } = made()
  source().tells('run')
  pulse.contact.set({ state: 'silent', since: 0 })
  pass(1)
  pulse.contact.set({ state: 'well' })
  pass(1)
  expect(Source.made).toHaveLength(1)
})

it('replaces a stream that is silent, and reads what it did not tell', () => {
  const { source, states, missed, pass } = made()
  source().tells('run')
  for (let i = 0; i < 8; i++) {
    pass(15)
    source().tells('beat')
  }
  expect(Source.made).toHaveLength(1)
  pass(40)
  expect(Source.made).toHaveLength(1)
  pass(0.25)
  expect(Source.made).toHaveLength(2)
  expect(Source.made[0]?.readyState).toBe(Source.CLOSED)
  expect(states.at(-1)).toBe(false)
  expect(missed).not.toHaveBeenCalled()
  source().tells('run')
  expect(states.at(-1)).toBe(true)
  expect(missed).toHaveBeenCalledOnce()
})
