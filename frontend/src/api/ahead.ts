// Prefetch: what the most frequent pages show first is asked for before their code is loaded, in one request, so that the
// service responds while the browser still parses that code.
import { at, inside } from '../format/root'

/** How long a response counts as fresh, as in the query cache [ms]. */
const FRESH = 15_000

const ALL = ['/session', '/workers']
const PAGES: Record<string, readonly string[]> = {
  '/runs': ['/runs?limit=100', '/runs/facets'],
  '/launch': ['/components', '/campaigns', '/runs/facets', '/drafts'],
}
const PARTS = ['', '/stages', '/findings', '/components', '/traces']

type Answers = ReadonlyMap<string, Response>

/** What is on its way, by the path of the request that it answers. */
const coming = new Map<string, Promise<Answers>>()

/** Asks for what the page at this address shows first. */
export function askAhead({ pathname, search }: Pick<Location, 'pathname' | 'search'>): void {
  const path = inside(pathname)
  const run = /^\/runs\/R-\d+$/.exec(path)?.[0]
  if (run) {
    const flights = ['nominal', new URLSearchParams(search).get('finding') ?? 'F1']
    ask([...ALL, ...PARTS.map((part) => run + part), ...flights.map((name) => `${run}/traces/${encodeURIComponent(name)}?max_points=1500`)])
    ask([`${run}/evaluations?max_points=2`]) // of a long search they take long: nothing else waits for them
  } else ask([...ALL, ...(path === '/runs' && search ? [] : (PAGES[path] ?? []))])
  setTimeout(() => coming.clear(), FRESH)
}

function ask(paths: readonly string[]): void {
  const answers = answersTo(paths).catch(() => new Map<string, Response>())
  for (const path of paths) coming.set(`/api/v1${path}`, answers)
}

/** What the service could answer; a refusal is left to the request itself. */
async function answersTo(paths: readonly string[]): Promise<Answers> {
  const response = await fetch(at(`/api/v1/batch?${new URLSearchParams(paths.map((path) => ['path', path]))}`))
  const lines = response.ok ? (await response.text()).split('\n') : []
  const answers = new Map<string, Response>()
  for (let line = 0; line + 1 < lines.length; line += 2) {
    const { path, etag } = JSON.parse(lines[line] ?? '') as { path: string; etag: string | null }
    answers.set(path, responseOf(lines[line + 1] ?? '', etag))
  }
  return answers
}

/** A response with this text, which is not encoded and decoded again. */
function responseOf(text: string, etag: string | null): Response {
  const response = new Response(null, { headers: { 'Content-Type': 'application/json', ...(etag !== null && { ETag: etag }) } })
  return Object.assign(response, { text: () => Promise.resolve(text) })
}

/** Answers a request from what was asked ahead, once and only while that is fresh; otherwise sends it. */
export async function fetchOnce(request: Request): Promise<Response> {
  const { pathname, search } = new URL(request.url)
  const path = inside(pathname) + search
  const answers = request.method === 'GET' ? coming.get(path) : undefined
  coming.delete(path)
  return (await answers)?.get(path) ?? fetch(request)
}
