// The page's hold on its 3D view: what the view is to show goes there by a key that only this page knows, so that the
// view is opened once and never again. Start reading at `View`.
import { changeView, getView } from '../api/calls'
import type { ViewChange, ViewState } from '../client'

export type Camera = NonNullable<ViewState['camera']>
export const CAMERAS: readonly Camera[] = ['overview', 'encounter', 'top', 'side', 'chase', 'intruder']

/** Between two changes at least [ms]: what comes meanwhile goes together, the newest of each kind. */
const PAUSE = 40
/** How long the service waits for the view to open, at most [s]. */
const OPENING = 30

/** What the page has its view show; told again to one that its frame has opened anew. */
export type Wanted = Required<Pick<ViewChange, 'flight' | 'theme'>>

/** Two changes as one: a time replaces what was said of it before, steps add up. */
export function merged(before: ViewChange, next: ViewChange): ViewChange {
  const { time, step, closest, passing, ...rest } = { ...before, ...next }
  if (next.closest) return { ...rest, closest: true }
  if (typeof next.time === 'number')
    return { ...rest, time: next.time, ...(next.step && { step: next.step }), ...(next.passing && { passing: true }) }
  if (!next.step) {
    const kept = { ...(step != null && { step }), ...(closest && { closest }), ...(passing && { passing }) }
    return { ...rest, ...(time != null && { time }), ...kept }
  }
  // A step from the closest approach cannot be said in one: the step alone is what was asked last.
  return { ...rest, ...(time != null && { time }), step: (before.step ?? 0) + next.step }
}

/** A random UUID (RFC 9562, version 4), also where the page came by plain HTTP. */
function uuid(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(16))
  bytes[6] = ((bytes[6] ?? 0) & 0x0f) | 0x40
  bytes[8] = ((bytes[8] ?? 0) & 0x3f) | 0x80
  const hex = Array.from(bytes, (byte) => byte.toString(16).padStart(2, '0')).join('')
  return hex.replace(/^(.{8})(.{4})(.{4})(.{4})(.{12})$/, '$1-$2-$3-$4-$5')
}

export interface Place {
  time?: number
  camera?: Camera
}

/** Where a view is opened: what it shows is behind the `#`, so that every view of a run is one kept page. */
export function addressOf(run: string, { flight, theme }: Wanted, { time, camera }: Place, key?: string): string {
  const parts = [flight, ...(time === undefined ? [] : ['t', String(time)]), ...(camera ? ['cam', camera] : []), theme]
  return key ? `/view/${run}/#${[...parts, 'key', key].join('/')}/` : `/view/${run}/${parts.join('/')}/`
}

export class View {
  readonly run: string
  readonly key = uuid()
  /** What the view has last been known to show; null before it is open, and after it was lost. */
  shown: ViewState | null = null
  /** Whether waiting for it is of no use any more. */
  failed = false
  private wanted: Wanted | null = null
  /** Which of it the view has been told. */
  private told: Wanted | null = null
  private pending: ViewChange = {}
  private busy = false
  private abort: AbortController | null = null
  private readonly listeners = new Set<() => void>()

  constructor(run: string) {
    this.run = run
  }

  /** Begin to steer: the frame is there. Ends with what is returned. */
  open(): () => void {
    const abort = new AbortController()
    this.abort = abort
    this.busy = this.failed = false
    void this.send(OPENING)
    return () => {
      abort.abort()
      this.abort = null
      this.pending = {}
      this.tell(null)
    }
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
    void this.send(0)
  }

  /** What it shows now, which its visitor may have changed in it; null where there is none. */
  async look(): Promise<ViewState | null> {
    const { abort } = this
    if (!abort || !this.shown) return null
    const shown = await getView(this.run, this.key, abort.signal).catch(() => null)
    if (shown && this.abort === abort) this.tell(shown)
    return shown
  }

  /** For `useSyncExternalStore`. */
  readonly subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener)
    return () => this.listeners.delete(listener)
  }

  private async send(wait: number): Promise<void> {
    const { abort } = this
    if (!abort || this.busy || this.failed || (wait === 0 && !this.shown)) return
    this.busy = true
    const { wanted } = this
    const change = { ...this.pending, ...(this.told === wanted && wait === 0 ? {} : wanted) }
    this.pending = {}
    const before = this.shown
    const shown = await changeView(this.run, this.key, change, wait, abort.signal).catch(() => null)
    if (shown) await new Promise((resolve) => setTimeout(resolve, PAUSE))
    if (this.abort !== abort) return
    this.busy = false
    this.failed = shown === null && wait > 0
    this.told = shown === null || (before !== null && before.opened !== shown.opened) ? null : wanted
    this.tell(shown)
    // One that is lost, with its socket, is opened anew by the frame itself.
    if (shown === null) void this.send(OPENING)
    else if (Object.keys(this.pending).length > 0 || this.told !== this.wanted) void this.send(0)
  }

  private tell(shown: ViewState | null): void {
    this.shown = shown
    for (const listener of this.listeners) listener()
  }
}
