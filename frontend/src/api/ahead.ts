// What the page of a run and the run list ask the service for first is asked for ahead of the code that shows it: the
// service answers while the browser still reads that code. Start reading at `askAhead`.

/** For how long an answer may be taken for a fresh one, as in the query cache [ms]. */
const FRESH = 15_000

const asked = new Map<string, Promise<Response>>()
/** From the page's own first request on it asks for itself. */
let open = true

/** Sends the requests of the page at this address, what decides most of the page first. */
export function askAhead({ pathname, search }: Pick<Location, 'pathname' | 'search'>): void {
  const run = /^\/runs\/(R-\d+)$/.exec(pathname)?.[1]
  if (run) askRun(`/api/v1/runs/${run}`, new URLSearchParams(search).get('finding') ?? 'F1')
  else if (pathname === '/runs' && !search) ask('/api/v1/session', '/api/v1/runs?limit=100')
}

function askRun(run: string, chosen: string): void {
  ask('/api/v1/session', run, `${run}/traces`, `${run}/stages`, `${run}/findings`, `${run}/components`)
  void namesOf(asked.get(`${run}/traces`)).then((names) => {
    const shown = names.filter((name) => name === 'nominal' || name === chosen)
    ask(...shown.map((name) => `${run}/traces/${name}?max_points=1500`), `${run}/evaluations?max_points=2000`)
  })
  // Symbols are Greek, for which the font has a file of its own.
  void document.fonts.load('1em "Inter Variable"', 'α')
}

/** Answers a request with what was asked for ahead, once and only while that is fresh; else by asking. */
export function fetchOnce(request: Request): Promise<Response> {
  open = false
  const { pathname, search } = new URL(request.url)
  const found = request.method === 'GET' && asked.get(pathname + search)
  if (!found) return fetch(request)
  asked.delete(pathname + search)
  return found
}

function ask(...urls: string[]): void {
  if (!open) return
  for (const url of urls) {
    const end = new AbortController()
    const answer = fetch(url, { signal: end.signal })
    // Whoever takes it hears of a failure; an answer that nobody takes is none.
    answer.catch(() => undefined)
    asked.set(url, answer)
    // An answer that nobody reads would keep its connection, of which a browser has six.
    setTimeout(() => asked.delete(url) && end.abort(), FRESH)
  }
}

async function namesOf(traces: Promise<Response> | undefined): Promise<string[]> {
  try {
    const answer = (await traces)?.clone()
    return answer?.ok ? ((await answer.json()) as { name: string }[]).map((trace) => trace.name) : []
  } catch {
    return []
  }
}
