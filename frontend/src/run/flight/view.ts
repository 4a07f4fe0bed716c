// Controls the page's 3D view: changes are sent with a key that only this page has, and movements of camera and time are
// received. `reconnect` is its state machine.
import { changeView, getView } from '../../api/calls'
import { uuid } from '../../api/keys'
import { Refusal } from '../../api/problems'
import { signedOut } from '../../api/session'
import type { ViewChange, ViewState } from '../../client'
import { CLOSED, type Event, type Machine, next, phaseOf, reframed, statementOf } from './reconnect'
import { addressOf, again, merged, type Place, type Wanted } from '../data/viewChange'

/** Minimum interval between changes [ms]: pending ones are merged, the newest of each kind. */
const PAUSE = 40
/** Minimum interval between updates [ms] while the flight plays. */
const NEWS = 100
/** Maximum wait of the service for a change [s]. */
const QUIET = 25
/** Additional time after which a response is considered lost [s]. */
const LATE = 10
/** How long to wait for a focused frame, which reopens a lost socket by itself [s]. */
const OWN = 3
/** Retry interval if the service does not respond [ms]. */
const RETRY = 2000
/** How long the notice of a restored view is shown [ms]. */
const BACK = 8000

/** The state of the view as known to the page. */
export interface Known {
  /** The displayed state; null while the view is not open. */
  shown: ViewState | null
  phase: ReturnType<typeof phaseOf>
  /** A notice for the visitor: the problem and what to do, or that the view is restored. */
  statement: string
  /** Address and number of the frame: a lost one is replaced. */
  address: string | null
  frame: number
}

export class View {
  readonly run: string
  readonly key = uuid()
  known: Known = { shown: null, phase: 'opening', statement: '', address: null, frame: 0 }
  private readonly simulates: boolean
  private machine: Machine = CLOSED
  /** The last displayed state, also after a loss. */
  private last: ViewState | null = null
  private wanted: Wanted | null = null
  /** The part of it that has been sent to the view. */
  private sent: Wanted | null = null
  private pending: ViewChange = {}
  private busy = false
  private abort: AbortController | null = null
  /** Aborts the pending request for changes. */
  private hurry: () => void = () => undefined
  private readonly listeners = new Set<() => void>()

  /** @param simulates Whether a view that is opened again simulates its what-if itself; a simulator is only evaluated on request. */
  constructor(run: string, simulates = true) {
    this.run = run
    this.simulates = simulates
  }

  /** Opens the view at an address, until the returned function is called. */
  open(place: Place): () => void {
    if (!this.wanted) return () => undefined
    const abort = new AbortController()
    this.abort = abort
    this.frame(place)
    this.take({ kind: 'wanted' })
    void this.live(abort.signal)
    const seen = () => this.hurry()
    document.addEventListener('visibilitychange', seen)
    window.addEventListener('online', seen)
    return () => {
      document.removeEventListener('visibilitychange', seen)
      window.removeEventListener('online', seen)
      abort.abort()
      this.abort = null
      this.pending = {}
      this.take({ kind: 'left' })
      this.tell({ shown: null, address: null })
    }
  }

  /** Retries after a failure. */
  retry(): void {
    if (!this.abort || this.machine.name !== 'failed') return
    this.take({ kind: 'retried' })
    void this.live(this.abort.signal)
  }

  /** Sets the state that the page requires. */
  want(wanted: Wanted): void {
    if (this.wanted?.flight === wanted.flight && this.wanted.theme === wanted.theme) return
    this.wanted = wanted
    this.steer({})
  }

  /** Changes the display as soon as possible. */
  steer(change: ViewChange): void {
    this.pending = merged(this.pending, change)
    void this.send()
  }

  /** Starts or pauses playback. */
  toggle(): void {
    if (this.known.shown) this.steer({ playing: !this.known.shown.playing })
  }

  /** The current state; null without a view. */
  async look(): Promise<ViewState | null> {
    const { abort } = this
    if (!abort || !this.known.shown) return null
    return getView(this.run, this.key, abort.signal).catch(() => null)
  }

  /** For `useSyncExternalStore`. */
  readonly subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener)
    return () => this.listeners.delete(listener)
  }

  /** The displayed time [s], for charts over time. */
  readonly time = (): number | null => this.known.shown?.time ?? null

  /** Runs the action of each state and feeds its result to the machine, until the page is left or the view has failed. */
  private async live(signal: AbortSignal): Promise<void> {
    while (!signal.aborted && this.machine.name !== 'failed') {
      const event = await this.doing(signal).catch(faultOf)
      if (!signal.aborted) this.take(event)
    }
  }

  private async doing(signal: AbortSignal): Promise<Event> {
    if (this.machine.name === 'open') return this.listen(signal)
    if (this.machine.name === 'asking') return this.ask(signal)
    await this.rest(RETRY, signal)
    return { kind: 'rested' }
  }

  private take(event: Event): void {
    const before = this.machine
    this.machine = next(before, event)
    const { machine } = this
    if (machine === before) return
    if (machine.restores === 'part') this.last = null // its last state no longer exists: open it in the page's state
    if (reframed(before, machine)) this.frame(this.last ? placeOf(this.last) : {})
    if (machine.name === 'open' && before.name === 'open') return
    const statement = statementOf(machine)
    this.tell({ phase: phaseOf(machine), statement, ...(machine.name !== 'open' && { shown: null }) })
    if (machine.name === 'open' && statement) setTimeout(() => this.known.statement === statement && this.tell({ statement: '' }), BACK)
  }

  /** Sends the complete state once the view is open. */
  private async ask(signal: AbortSignal): Promise<Event> {
    const { wanted, last, machine, pending } = this
    this.pending = {} // pending changes are sent once it is open
    const before = last ? again(last, this.simulates) : {}
    const change = merged(before, { ...pending, ...wanted })
    const inTime = anyOf(signal, lateAfter(machine.wait))
    const answer = await changeView(this.run, this.key, change, machine.wait, inTime).catch(refusedFor)
    if (signal.aborted || answer instanceof Refusal) {
      if (this.abort?.signal === signal) this.pending = merged(pending, this.pending)
      return eventOf(answer)
    }
    this.sent = wanted
    this.last = answer
    this.tell({ shown: answer })
    void this.send()
    return { kind: 'opened' }
  }

  /** Waits for a change of the display, or its loss; pauses while the page is hidden. */
  private async listen(signal: AbortSignal): Promise<Event> {
    if (document.hidden) {
      await this.rest(Number.POSITIVE_INFINITY, signal)
      return { kind: 'heard' }
    }
    const since = this.known.shown?.revision ?? 0
    const late = lateAfter(QUIET)
    const woken = new AbortController()
    this.hurry = () => woken.abort()
    const until = anyOf(signal, late, woken.signal)
    const answer = await getView(this.run, this.key, until, { since, wait: QUIET }).catch(refusedFor)
    const failed = answer instanceof Refusal && (late.aborted || !until.aborted)
    const wait = document.activeElement instanceof HTMLIFrameElement ? OWN : 0
    if (answer instanceof Refusal && answer.status === 404) return { kind: 'absent', wait }
    if (answer instanceof Refusal && answer.status === 410) return { kind: 'barred', why: answer.message }
    if (!(answer instanceof Refusal)) this.hear(answer)
    await this.rest(NEWS, signal)
    return failed ? { kind: 'missed', wait } : { kind: 'heard' }
  }

  /** Sends pending changes, one request at a time. */
  private async send(): Promise<void> {
    if (this.busy) return
    this.busy = true
    while (this.abort && this.known.shown && (Object.keys(this.pending).length > 0 || this.sent !== this.wanted)) {
      const { wanted, abort } = this
      const change = { ...this.pending, ...(this.sent === wanted ? {} : wanted) }
      this.pending = {}
      const answer = await changeView(this.run, this.key, change, 0, abort.signal).catch(refusedFor)
      if (this.abort !== abort) break
      if (!(answer instanceof Refusal)) this.sent = wanted
      else if (answer.status === 422) this.sent = wanted // a repetition would be refused again
      else {
        this.pending = merged(change, this.pending)
        this.hurry() // the listening loop detects the problem
        break
      }
      if (!(answer instanceof Refusal)) this.hear(answer)
      await new Promise((resolve) => setTimeout(resolve, PAUSE))
    }
    this.busy = false
  }

  /** Stores the state; responses may arrive out of order. */
  private hear(shown: ViewState): void {
    if (!this.known.shown || shown.revision < this.known.shown.revision) return
    this.last = shown
    if (shown.revision !== this.known.shown.revision) this.tell({ shown })
  }

  /** Creates a frame, replacing the current one. */
  private frame(place: Place): void {
    if (!this.wanted) return
    this.tell({ address: addressOf(this.run, this.wanted, place, this.key), frame: this.known.frame + 1 })
  }

  /** Waits for a time [ms], or until woken. */
  private async rest(time: number, signal: AbortSignal): Promise<void> {
    await new Promise<void>((resolve) => {
      const timer = Number.isFinite(time) ? setTimeout(() => done(), time) : undefined
      const done = () => {
        clearTimeout(timer)
        signal.removeEventListener('abort', done)
        resolve()
      }
      signal.addEventListener('abort', done)
      this.hurry = done
    })
  }

  private tell(change: Partial<Known>): void {
    this.known = { ...this.known, ...change }
    for (const listener of this.listeners) listener()
  }
}

export const refusedFor = (error: unknown): Refusal => (error instanceof Refusal ? error : new Refusal(0, 'No response', 'The service does not respond.'))

/** What this page or the browser cannot do: the view fails, and says so, rather than open for ever. */
const faultOf = (error: unknown): Event => ({
  kind: 'barred',
  why: `This browser cannot show the 3D view (${error instanceof Error ? error.message : String(error)}). Try again, or use a newer browser.`,
})

/** Aborts a request that the service may answer after a wait [s], and has not. */
const lateAfter = (wait: number): AbortSignal => AbortSignal.timeout((wait + LATE) * 1000)

const placeOf = ({ time, camera }: ViewState): Place => ({ time, ...(camera && { camera }) })

/** Aborted as soon as one of these is: browsers of 2023 have no AbortSignal.any. */
export function anyOf(...signals: AbortSignal[]): AbortSignal {
  const one = new AbortController()
  for (const signal of signals) {
    if (signal.aborted) one.abort(signal.reason)
    signal.addEventListener('abort', () => one.abort(signal.reason), { signal: one.signal })
  }
  return one.signal
}

function eventOf(answer: ViewState | Refusal): Event {
  if (!(answer instanceof Refusal)) return { kind: 'opened' }
  const { status, message: why } = answer
  if (status === 404) return { kind: 'absent' }
  if (status === 422) return { kind: 'refused', why }
  if (status === 0 || status >= 500) return { kind: 'silent', why }
  if (status !== 401) return { kind: 'barred', why }
  signedOut()
  return { kind: 'barred', why: 'You are signed out: open a login link of the service, then open the 3D view again.' }
}
