// An event stream that lasts. A browser reconnects by itself, but only after a lost connection: after any answer but 200 it
// gives up, and a connection that sleep, another network or a proxy has cut without a word stays open for ever.
import { pulse } from './pulse'

/** Pause before a stream that was refused is opened again, doubled with every refusal up to the longest [ms]. */
const [PAUSE, LONGEST] = [2000, 30_000]
/** A stream that is silent for longer is lost: the service sends a beat every 15 s [ms]. */
const SILENCE = 40_000

interface Listener {
  /** Whether events come, each time that may have changed. */
  open: (open: boolean) => void
  /** Another stream has taken the place of one that was lost: events may be missing. */
  missed: () => void
}

export class Feed {
  private source: EventSource
  private heard = 0
  private replaces = false
  private refusals = 0
  /** When a refused stream is opened again; null for one that was not refused. */
  private due: number | null = null
  private well = true

  /** events: what is done with the data of each. */
  constructor(
    private readonly address: string,
    private readonly events: Readonly<Record<string, (data: string) => void>>,
    private readonly listener: Listener,
  ) {
    this.source = this.opened()
  }

  /** Replaces a stream that was lost; called several times a second. */
  tick(): void {
    const well = pulse.contact.get().state === 'well'
    const recovered = well && !this.well
    this.well = well
    if (recovered) this.refusals = 0
    const again = this.due !== null && (recovered || Date.now() >= this.due)
    if (again || Date.now() - this.heard > SILENCE) this.renew()
  }

  /** Opens the stream again. */
  renew(): void {
    this.source.close()
    this.replaces = true
    this.source = this.opened()
  }

  close(): void {
    this.source.close()
  }

  private opened(): EventSource {
    this.heard = Date.now()
    this.due = null
    this.listener.open(false)
    const source = new EventSource(this.address)
    // Open by its first event, which the service sends at once: a proxy may hold back all but the headers.
    const events: typeof this.events = { ...this.events, beat: () => undefined }
    for (const [name, take] of Object.entries(events))
      source.addEventListener(name, (event) => {
        this.hear()
        take((event as MessageEvent<string>).data)
      })
    source.addEventListener('error', () => {
      this.listener.open(false)
      if (source.readyState === EventSource.CLOSED)
        this.due = Date.now() + Math.min(PAUSE * 2 ** this.refusals++, LONGEST)
    })
    return source
  }

  private hear(): void {
    pulse.beat()
    this.heard = Date.now()
    this.refusals = 0
    this.listener.open(true)
    if (this.replaces) this.listener.missed()
    this.replaces = false
  }
}
