// Components without a browser: what they return is looked at, their handlers are called, and a service answers as told.
import { QueryClientProvider } from '@tanstack/react-query'
import { act, isValidElement, type ReactElement, type ReactNode, useEffect, useId } from 'react'
import { expect, vi } from 'vitest'
import { Cache, sessionQuery } from '../src/api/queries'
import { client } from '../src/client/client.gen'

/** An element with whatever it was given. */
type Given = ReactElement<Record<string, unknown>>
/** What a user does to an element. */
export type Call = (...given: unknown[]) => unknown

const within = (node: unknown): Given[] => {
  if (Array.isArray(node)) return node.flatMap(within)
  return isValidElement<Record<string, unknown>>(node) ? [node, ...Object.values(node.props).flatMap(within)] : []
}

interface LookProps {
  of: ReactElement
  /** The components that are looked into as well, by name. */
  into: readonly string[]
  see: (id: string, tree: ReactNode) => void
}

/** Calls a component and shows what it returns to the test instead of drawing it: there is no browser here. */
function Look({ of, into, see }: LookProps) {
  const id = useId()
  const Component = of.type as (props: unknown) => ReactNode
  const tree = Component(of.props)
  useEffect(() => see(id, tree))
  useEffect(() => () => see(id, null), [id, see])
  return within(tree).map((one) => {
    const name = typeof one.type === 'function' ? one.type.name : ''
    return into.includes(name) && <Look key={name + String(one.key)} of={one} into={into} see={see} />
  })
}

export const nothing = () => undefined
/** Waits, if need be on a busy machine. */
export const until = <T,>(test: () => T) => vi.waitFor(test, { timeout: 30_000, interval: 5 })
export const cache = new Cache({ defaultOptions: { queries: { retry: false } } })
let shown = new Map<string, ReactNode>()
let close: () => void = nothing
/** Fails until the router has done what it does. */
let settled: () => unknown = nothing
export const settledOnce = (test: () => unknown) => void (settled = test)

export const all = () => [...shown.values()].flatMap(within)
export const one = (test: (element: Given) => boolean): Given => {
  const found = all().find(test)
  if (!found) throw new Error('There is no such element.')
  return found
}
export const of = (type: unknown, more: Record<string, unknown> = {}) =>
  one(({ type: own, props }) => own === type && Object.entries(more).every(([key, value]) => props[key] === value))
export const call = (element: Given, name: string, ...given: unknown[]) => (element.props[name] as Call)(...given)

/** Shows a page; returns how to show it otherwise. Another key is another card. */
export async function open(element: ReactElement, into: readonly string[] = [], around = (inner: ReactElement) => inner) {
  const { createRoot } = await import('react-dom/client')
  const page = { nodeType: 9, defaultView: window, activeElement: null, addEventListener: nothing, removeEventListener: nothing }
  vi.stubGlobal('document', page)
  const root = createRoot({ ...page, nodeType: 1, tagName: 'DIV', ownerDocument: page } as never)
  const see = (id: string, tree: ReactNode) => void (tree === null ? shown.delete(id) : shown.set(id, tree))
  const show = (of: ReactElement) => {
    root.render(<QueryClientProvider client={cache}>{around(<Look key={of.key} of={of} into={into} see={see} />)}</QueryClientProvider>)
  }
  close = () => root.unmount()
  show(element)
  await until(() => expect(all()).not.toEqual([]))
  return show
}

/** Answers of the service by request, such as GET runs/R-0001; what it was asked. */
export const service: Record<string, (request: Request, body: string) => unknown> = {}
export const asked: { what: string; match: string | null; body: unknown }[] = []
async function answered(request: Request): Promise<Response> {
  const body = await request.text()
  const what = `${request.method} ${new URL(request.url).pathname.slice('/api/v1/'.length)}`
  asked.push({ what, match: request.headers.get('If-Match'), body: /^[{]/.test(body) ? JSON.parse(body) : body })
  const answer = await service[what]?.(request, body)
  return answer instanceof Response ? answer : Response.json(answer ?? {}, { status: answer ? 200 : 404 })
}

export const sent = (method: string) => asked.filter(({ what }) => what.startsWith(method)).map(({ body }) => body)
export const patches = () => asked.filter(({ what }) => what.startsWith('PATCH'))

/** Before each test. */
export function begin() {
  shown = new Map()
  for (const what of Object.keys(service)) delete service[what]
  asked.length = 0
  settled = nothing
  const frame = class {}
  const window = Object.assign(new EventTarget(), { setTimeout, clearTimeout, HTMLIFrameElement: frame, origin: 'http://service' })
  vi.stubGlobal('window', window)
  vi.stubGlobal('self', window)
  vi.stubGlobal('scrollTo', nothing)
  vi.stubGlobal('fetch', answered)
  client.setConfig({ baseUrl: 'http://service' })
  cache.setQueryData(sessionQuery.queryKey, { role: 'engineer', account: 'Ada' } as never)
}

/** After each test. */
export async function end() {
  await until(settled)
  vi.stubGlobal('IS_REACT_ACT_ENVIRONMENT', true)
  act(close)
  await new Promise((done) => setTimeout(done)) // what queries told just before still arrives
  cache.clear()
  client.setConfig({ baseUrl: '' })
  vi.unstubAllGlobals()
}

export const leaves = () => window.dispatchEvent(new Event('beforeunload', { cancelable: true }))
export const write = (text: string) => call(of('textarea'), 'onChange', { target: { value: text } })
export const text = (words: string) => all().some(({ props }) => props.children === words)
export const press = (words: string) => call(one(({ props }) => props.children === words), 'onClick')
export const send = () => call(of('form'), 'onSubmit', new Event('submit'))
