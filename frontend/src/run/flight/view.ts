// The page's hold on its 3D view: what it is to show goes there by a key that only this page knows, and where its visitor
// has moved the camera or the time has run comes back at once. `reconnect` says what becomes of it. Start at `View.live`.
import { changeView, getView } from '../../api/calls'
import { Refusal } from '../../api/problems'
import { signedOut } from '../../api/session'
import type { ViewChange, ViewState } from '../../client'
import { CLOSED, type Event, type Machine, next, phaseOf, reframed, saidOf } from './reconnect'
import { Request } from './request'
import { addressOf, again, merged, type Place, uuid, type Wanted } from '../data/viewChange'

/** Between two changes at least [ms]: what comes meanwhile goes together, the newest of each kind. */
const PAUSE = 40
/** Between two pieces of news at least [ms]: while the flight plays, the page goes along so often. */
const NEWS = 100
/** How long the service waits for news, at most [s]. */
const QUIET = 25
/** A frame that has the focus opens a lost socket anew by itself: for so long it is waited for [s]. */
const OWN = 3
/** How long it takes to ask again where the service does not answer [ms]. */
const RETRY = 2000
/** How long it is said that the view is back [ms]. */
const BACK = 8000

/** What the page knows of its view. */
export interface Known {
  /** What is shown; null while it is not open. */
  shown: ViewState | null
  phase: ReturnType<typeof phaseOf>
  /** A sentence for the visitor: what is wrong and what to do, or that it is back. */
  said: string
  /** Where the frame is, and which frame it is: one that is lost is replaced. */
  address: string | null
  frame: number
}

export class View {
  readonly run: string
  readonly key = uuid()
  known: Known = { shown: null, phase: 'opening', said: '', address: null, frame: 0 }
  private machine: Machine = CLOSED
  /** What it showed last, also after it was lost. */
  private last: ViewState | null = null
  private wanted: Wanted | null = null
  /** Which of it the view has been told. */
  private told: Wanted | null = null
  private pending: ViewChange = {}
  private busy = false
  private abort: AbortController | null = null
  /** Ends the request for news that is under way. */
  private hurry: () => void = () => undefined
  private readonly listeners = new Set<() => void>()

  constructor(run: string) {
    this.run = run
  }

  /** Open it at a place, and keep it open until what is returned is called. */
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

  /** Try once more after it was given up. */
  retry(): void {
    if (!this.abort || this.machine.name !== 'failed') return
    this.take({ kind: 'retried' })
    void this.live(this.abort.signal)
  }

  /** What the page wants it to show from now on. */
  want(wanted: Wanted): void {
    if (this.wanted?.flight === wanted.flight && this.wanted.theme === wanted.theme) return
    this.wanted = wanted
    this.steer({})
  }

  /** Have it show something else, as soon as it can. */
  steer(change: ViewChange): void {
    this.pending = merged(this.pending, change)
    void this.send()
  }

  /** Let the time run, or stand. */
  toggle(): void {
    if (this.known.shown) this.steer({ playing: !this.known.shown.playing })
  }

  /** What it shows at this moment; null where there is none. */
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

  /** The time that is shown [s], for charts over time. */
  readonly time = (): number | null => this.known.shown?.time ?? null

  /** Does what the state asks for and takes what comes of it, until the page is left or the view is given up. */
  private async live(signal: AbortSignal): Promise<void> {
    while (!signal.aborted && this.machine.name !== 'failed') {
      const event = await this.doing(signal)
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
    if (machine.restores === 'part') this.last = null // what it showed is there no more: it opens as the page has it
    if (reframed(before, machine)) this.frame(this.last ? placeOf(this.last) : {})
    if (machine.name === 'open' && before.name === 'open') return
    const said = saidOf(machine)
    this.tell({ phase: phaseOf(machine), said, ...(machine.name !== 'open' && { shown: null }) })
    if (machine.name === 'open' && said) setTimeout(() => this.known.said === said && this.tell({ said: '' }), BACK)
  }

  /** Tells it all that it is to show, once it is open. */
  private async ask(signal: AbortSignal): Promise<Event> {
    const { wanted, last, machine, pending } = this
    this.pending = {} // what is asked for meanwhile is sent once it is open
    const change = merged(last ? again(last) : {}, { ...pending, ...wanted })
    const asked = new Request(signal, machine.wait)
    const answer = await changeView(this.run, this.key, change, machine.wait, asked.signal).catch(refusedFor)
    asked.over()
    if (signal.aborted || answer instanceof Refusal) {
      if (this.abort?.signal === signal) this.pending = merged(pending, this.pending)
      return eventOf(answer)
    }
    this.told = wanted
    this.last = answer
    this.tell({ shown: answer })
    void this.send()
    return { kind: 'opened' }
  }

  /** News of what is shown, or that there is none; asks nothing while the page is hidden. */
  private async listen(signal: AbortSignal): Promise<Event> {
    if (document.hidden) {
      await this.rest(Number.POSITIVE_INFINITY, signal)
      return { kind: 'heard' }
    }
    const since = this.known.shown?.revision ?? 0
    const news = new Request(signal, QUIET)
    this.hurry = news.end
    const answer = await getView(this.run, this.key, news.signal, { since, wait: QUIET }).catch(refusedFor)
    news.over()
    const wait = document.activeElement instanceof HTMLIFrameElement ? OWN : 0
    if (answer instanceof Refusal && answer.status === 404) return { kind: 'absent', wait }
    if (!(answer instanceof Refusal)) this.hear(answer)
    await this.rest(NEWS, signal)
    const failed = answer instanceof Refusal && (news.late || !news.signal.aborted)
    return failed ? { kind: 'missed', wait } : { kind: 'heard' }
  }

  /** Sends what there is to change, one request at a time. */
  private async send(): Promise<void> {
    if (this.busy) return
    this.busy = true
    while (this.abort && this.known.shown && (Object.keys(this.pending).length > 0 || this.told !== this.wanted)) {
      const { wanted, abort } = this
      const change = { ...this.pending, ...(this.told === wanted ? {} : wanted) }
      this.pending = {}
      const answer = await changeView(this.run, this.key, change, 0, abort.signal).catch(refusedFor)
      if (this.abort !== abort) break
      if (!(answer instanceof Refusal)) this.told = wanted
      else if (answer.status === 422) this.told = wanted // asked again it would be refused again
      else {
        this.pending = merged(change, this.pending)
        this.hurry() // who listens finds out what is wrong
        break
      }
      if (!(answer instanceof Refusal)) this.hear(answer)
      await new Promise((resolve) => setTimeout(resolve, PAUSE))
    }
    this.busy = false
  }

  /** Takes what is shown; answers may overtake each other. */
  private hear(shown: ViewState): void {
    if (!this.known.shown || shown.revision < this.known.shown.revision) return
    this.last = shown
    if (shown.revision !== this.known.shown.revision) this.tell({ shown })
  }

  /** A frame, another one where there is one. */
  private frame(place: Place): void {
    if (!this.wanted) return
    this.tell({ address: addressOf(this.run, this.wanted, place, this.key), frame: this.known.frame + 1 })
  }

  /** Waits so long [ms], or until there is reason to hurry. */
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

const refusedFor = (error: unknown): Refusal => (error instanceof Refusal ? error : new Refusal(0, 'No answer', 'The service does not answer.'))

const placeOf = ({ time, camera }: ViewState): Place => ({ time, ...(camera && { camera }) })

/** What a refused opening is to the machine. */
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
