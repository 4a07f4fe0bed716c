// A request that may be ended from several sides. Start reading at `Request`.

/** An answer that takes so much longer does not come any more [s]. */
const LATE = 10

/** A request that ends with the page's interest, when there is reason to hurry, and when no answer comes. */
export class Request {
  late = false
  private readonly abort = new AbortController()
  private readonly outer: AbortSignal
  private readonly timer: ReturnType<typeof setTimeout>

  /** The service may wait so long before it answers [s]. */
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
