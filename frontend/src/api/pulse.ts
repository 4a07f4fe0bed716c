// Whether the service answers. Every answer and event is a sign of life, but not the 502 of a proxy in between. Without one
// the service is asked, and after 3 s without an answer all pages say so, until it answers again. So they do while its
// database cannot be used.
import { at } from '../format/root'
import { storeOf } from '../ui/store'
import { isOfProxy } from './problems'

/** Time without an answer after which it is reported [ms]. */
export const PATIENCE = 3000
/** A request that takes longer than this is a reason to ask whether the service answers at all: some take long [ms]. */
const SLOW = 500
/** The longest time without a sign of life on a visible page [ms]. */
const QUIET = 5000
/** Until an unanswered question is asked again [ms]. */
const AGAIN = 10_000
/** The pause after a refused connection, or an answer of a proxy [ms]. */
const PAUSE = 1500

/**
 * `silent`: connected, but without an answer, or with that of a proxy alone; `unreachable`: no connection; `unusable`: it answers why it can do nothing.
 * Since when [ms since 1970].
 */
export type Contact =
  | { state: 'well' }
  | { state: 'silent' | 'unreachable'; since: number }
  | { state: 'unusable'; since: number; why: string }

const WELL: Contact = { state: 'well' }

/**
 * `ask` resolves with any answer of the service: why it can do nothing, or nothing; with null if a proxy answers. It rejects
 * if there is no connection or the signal aborts it.
 */
export class Pulse {
  readonly contact = storeOf<Contact>(WELL)
  private heard: number
  private asking = false

  constructor(
    private readonly ask: (signal: AbortSignal) => Promise<string | void | null>,
    private readonly now: () => number = Date.now,
  ) {
    this.heard = now()
  }

  /** The service has answered something. */
  beat(): void {
    this.heard = this.now()
    if (['silent', 'unreachable'].includes(this.contact.get().state)) this.contact.set(WELL)
  }

  /** Follows a request: its answer is a sign of life, and the service is asked if it takes long. */
  async follow<T>(answer: Promise<T>): Promise<T> {
    const slow = setTimeout(() => void this.check(this.now() - SLOW), SLOW)
    try {
      const found = await answer
      const proxy = found instanceof Response && isOfProxy(found)
      if (!proxy) this.beat()
      if (proxy || (found instanceof Response && found.status === 503)) void this.check()
      return found
    } finally {
      clearTimeout(slow)
    }
  }

  /** Asks if nothing was heard for long, or if the service did not answer before. */
  tick(): void {
    if (this.contact.get().state !== 'well' || this.now() - this.heard >= QUIET) void this.check()
  }

  /** Asks the service, one question at a time. `since`: when it should have begun to answer. */
  async check(since = this.now()): Promise<void> {
    if (this.asking) return
    this.asking = true
    const abort = new AbortController()
    const late = setTimeout(() => this.lost('silent', since), Math.max(0, since + PATIENCE - this.now()))
    const again = setTimeout(() => abort.abort(), AGAIN)
    try {
      const why = await this.ask(abort.signal)
      if (why === null) {
        await this.refused('silent', since)
        return
      }
      this.beat()
      if (why) this.lost('unusable', since, why)
      else if (this.contact.get().state !== 'well') this.contact.set(WELL)
    } catch {
      if (!abort.signal.aborted) await this.refused('unreachable', since)
    } finally {
      clearTimeout(late)
      clearTimeout(again)
      this.asking = false
    }
  }

  /** There was an answer at once, but none of the service: it is not asked again at once. */
  private async refused(state: 'silent' | 'unreachable', since: number): Promise<void> {
    this.lost(state, since)
    await new Promise((resolve) => setTimeout(resolve, PAUSE))
  }

  private lost(state: 'silent' | 'unreachable' | 'unusable', since: number, why = ''): void {
    const before = this.contact.get()
    const from = before.state === 'well' ? since : before.since
    if (before.state === state && (before.state !== 'unusable' || before.why === why)) return
    this.contact.set(state === 'unusable' ? { state, since: from, why } : { state, since: from })
  }
}

/** Of this tab. Any answer of the service counts, also a refusal. */
export const pulse = new Pulse(async (signal) => {
  const answer = await fetch(at('/api/v1/health'), { signal, cache: 'no-store' })
  if (isOfProxy(answer)) return null
  return answer.status === 503 ? troubleOf(await answer.text()) : undefined
})

/** Why the service can do nothing; empty if it is only busy, or does not say. */
export function troubleOf(text: string): string {
  try {
    const { type, detail } = JSON.parse(text) as { type?: string; detail?: string }
    return detail && !type?.endsWith(':busy') ? detail : ''
  } catch {
    return ''
  }
}

export const useContact = pulse.contact.useValue
