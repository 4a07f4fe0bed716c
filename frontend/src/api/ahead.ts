// Prefetch: the first requests of the run page and the run list are sent before the code of the page is loaded, so that
// the service responds while the browser still parses that code.
import { at, inside } from '../format/root'

/** How long a response counts as fresh, as in the query cache [ms]. */
const FRESH = 15_000

const responses = new Map<string, Promise<Response>>()
/** False from the page's own first request on. */
let open = true

/** Sends the requests of the page at this address, the most important first. */
export function askAhead({ pathname, search }: Pick<Location, 'pathname' | 'search'>): void {
  const run = /^\/runs\/(R-\d+)$/.exec(inside(pathname))?.[1]
  if (run) askRun(`/api/v1/runs/${run}`, new URLSearchParams(search).get('finding') ?? 'F1')
  else if (inside(pathname) === '/runs' && !search) ask('/api/v1/session', '/api/v1/runs?limit=100')
}

function askRun(run: string, chosen: string): void {
  ask('/api/v1/session', run, `${run}/traces`, `${run}/stages`, `${run}/findings`, `${run}/components`)
  void namesOf(responses.get(`${run}/traces`)).then((names) => {
    const shown = names.filter((name) => name === 'nominal' || name === chosen)
    ask(...shown.map((name) => `${run}/traces/${name}?max_points=1500`), `${run}/evaluations?max_points=2000`)
  })
  // Greek symbols are in a separate font file.
  void document.fonts.load('1em "Inter Variable"', 'α')
}

/** Answers a request from the prefetched response, once and only while it is fresh; otherwise sends it. */
export function fetchOnce(request: Request): Promise<Response> {
  open = false
  const { pathname, search } = new URL(request.url)
  const found = request.method === 'GET' && responses.get(inside(pathname) + search)
  if (!found) return fetch(request)
  responses.delete(inside(pathname) + search)
  return found
}

function ask(...urls: string[]): void {
  if (!open) return
  for (const url of urls) {
    const end = new AbortController()
    const answer = fetch(at(url), { signal: end.signal })
    responses.set(url, answer)
    // A failure reaches only who already waits for it: a later request, such as after "Try again", is sent anew.
    const drop = () => responses.delete(url)
    answer.then((response) => response.ok || drop(), drop)
    // An unread response would block one of the browser's six connections.
    setTimeout(() => responses.delete(url) && end.abort(), FRESH)
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
