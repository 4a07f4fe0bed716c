// A request with several abort conditions.

/** Additional time after which a response is considered lost [s]. */
const LATE = 10

/** A request that is aborted when no longer needed, when woken, and after a timeout. */
export class Request {
  late = false
  private readonly abort = new AbortController()
  private readonly outer: AbortSignal
  private readonly timer: ReturnType<typeof setTimeout>

  /** Time that the service may wait before it responds [s]. */
  constructor(outer: AbortSignal, wait: number) {
    this.outer = outer
    this.timer = setTimeout(() => {
      this.late = true
      this.end()
    }, (wait + LATE) * 1000)
    outer.addEventListener('abort', this.end)
  }

  get signal(): AbortSignal {
    return this.abort.signal
  }

  readonly end = (): void => this.abort.abort()

  over(): void {
    clearTimeout(this.timer)
    this.outer.removeEventListener('abort', this.end)
  }
}
