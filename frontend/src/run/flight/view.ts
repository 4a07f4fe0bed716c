// The page's hold on its 3D view: what it is to show goes there by a key that only this page knows, and what its visitor
// changes in it comes back at once. One that is lost is opened again as it was. Start reading at `View.live`.
import { changeView, getView } from '../../api/calls'
import { Refusal } from '../../api/problems'
import { signedOut } from '../../api/session'
import type { ViewChange, ViewState } from '../../client'
import { Request } from './request'
import { addressOf, again, merged, type Place, uuid, type Wanted } from '../data/viewChange'

/** Between two changes at least [ms]: what comes meanwhile goes together, the newest of each kind. */
const PAUSE = 40
/** Between two pieces of news at least [ms]: while the flight plays, the page goes along so often. */
const NEWS = 100
/** How long the service waits for a view to open, or for news of it, at most [s]. */
const OPENING = 30
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
  phase: 'opening' | 'open' | 'lost' | 'failed'
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
  private readonly choosers = new Set<(flight: string) => void>()

  constructor(run: string) {
    this.run = run
  }

  /** Open it at a place, and keep it open until what is returned is called. */
  open(place: Place): () => void {
    const abort = new AbortController()
    this.abort = abort
    this.begin(place)
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
      this.tell({ shown: null, phase: 'opening', said: '', address: null })
    }
  }

  /** Give up waiting, and try once more from the beginning. */
  retry(): void {
    if (!this.abort || this.known.phase !== 'failed') return
    this.anew()
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

  /** Calls with each finding that the visitor chooses in the view itself, until what is returned is called. */
  chosen(listener: (flight: string) => void): () => void {
    this.choosers.add(listener)
    return () => this.choosers.delete(listener)
  }

  /** The time that is shown [s], for charts over time. */
  readonly time = (): number | null => this.known.shown?.time ?? null

  /** Opens it, listens to it, and opens it again when it was lost, for as long as the page is there. */
  private async live(signal: AbortSignal): Promise<void> {
    let wait = OPENING
    while (!signal.aborted && (await this.enter(wait, signal))) {
      await this.listen(signal)
      if (signal.aborted) return
      const said = 'The 3D view was lost. It is being opened again, as it was.'
      this.tell({ shown: null, phase: 'lost', said })
      wait = document.activeElement instanceof HTMLIFrameElement ? OWN : 0
    }
  }

  /** Tells it all that it is to show once it is open, in a new frame where the old one does not come back. */
  private async enter(first: number, signal: AbortSignal): Promise<boolean> {
    let wait = first
    let said = this.last ? 'The 3D view was lost and is back, as it was.' : ''
    for (let frames = first === OPENING ? 1 : 0; !signal.aborted; ) {
      const { wanted, last } = this
      const change = merged(last ? again(last) : {}, { ...this.pending, ...wanted })
      const asked = new Request(signal, wait)
      const answer = await changeView(this.run, this.key, change, wait, asked.signal).catch(refusedFor)
      asked.over()
      if (signal.aborted) return false
      if (!(answer instanceof Refusal)) {
        this.pending = {}
        this.told = wanted
        this.back(answer, said)
        void this.send()
        return true
      }
      if (answer.status === 404 && frames < 2) {
        frames += 1
        wait = OPENING
        this.anew()
      } else if (answer.status === 422 && last) {
        this.last = null // what it showed is there no more: it opens as the page has it
        said = 'The 3D view was lost and is back, but not all that it showed is still there.'
      } else if (answer.status === 0 || answer.status >= 500) {
        const why = `${answer.message} The 3D view is opened again as it was, as soon as that is possible.`
        this.tell({ shown: null, phase: 'lost', said: why })
        wait = frames = 0
        await this.rest(RETRY, signal)
      } else {
        if (answer.status === 401) signedOut()
        this.tell({ shown: null, phase: 'failed', said: saidOf(answer) })
        return false
      }
    }
    return false
  }

  /** Hears what is shown otherwise, until the view is lost; asks nothing while the page is hidden. */
  private async listen(signal: AbortSignal): Promise<void> {
    for (let lost = 0; !signal.aborted && lost < 2; ) {
      if (document.hidden) {
        await this.rest(Number.POSITIVE_INFINITY, signal)
        continue
      }
      const since = this.known.shown?.revision ?? 0
      const news = new Request(signal, QUIET)
      this.hurry = news.end
      const answer = await getView(this.run, this.key, news.signal, { since, wait: QUIET }).catch(refusedFor)
      news.over()
      if (!(answer instanceof Refusal)) {
        lost = 0
        this.hear(answer)
      } else if (answer.status === 404) return
      else if (news.late || !news.signal.aborted) lost += 1
      await this.rest(NEWS, signal)
    }
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
    this.adopt()
  }

  /** Takes what is shown; answers may overtake each other. */
  private hear(shown: ViewState): void {
    if (this.known.shown && shown.revision < this.known.shown.revision) return
    this.last = shown
    if (shown.revision !== this.known.shown?.revision) this.tell({ shown, phase: 'open' })
    this.adopt()
  }

  /** A finding that the page has not asked for is the visitor's choice: it is the page's, too, from now on. */
  private adopt(): void {
    const { shown } = this.known
    if (this.busy || !shown || !this.wanted || this.told !== this.wanted || shown.flight === this.wanted.flight) return
    this.wanted = this.told = { ...this.wanted, flight: shown.flight }
    for (const listener of this.choosers) listener(shown.flight)
  }

  private begin(place: Place): void {
    if (!this.wanted) return
    const address = addressOf(this.run, this.wanted, place, this.key)
    this.tell({ shown: null, phase: 'opening', said: '', address, frame: this.known.frame + 1 })
  }

  /** Another frame in place of the one that is lost. */
  private anew(): void {
    const { last, wanted } = this
    if (!wanted) return
    const place = last ? { time: last.time, ...(last.camera && { camera: last.camera }) } : {}
    const phase = this.known.phase === 'lost' ? 'lost' : 'opening'
    this.tell({ address: addressOf(this.run, wanted, place, this.key), frame: this.known.frame + 1, phase })
  }

  private back(shown: ViewState, said: string): void {
    this.last = shown
    this.tell({ shown, phase: 'open', said })
    if (said) setTimeout(() => this.known.said === said && this.tell({ said: '' }), BACK)
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

/** Why a view cannot be opened, and what to do. */
function saidOf(refusal: Refusal): string {
  if (refusal.status === 401) return 'You are signed out: open a login link of the service, then open the 3D view again.'
  if (refusal.status === 404)
    return 'The 3D view did not open. Where the browser can draw no 3D graphics (WebGL), switch them on; otherwise try again.'
  return refusal.message
}
