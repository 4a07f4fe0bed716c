// What a user has typed and not saved yet: it is kept, saved over what was read, and not lost to a change from elsewhere.
import { TagsInput } from '@mantine/core'
import { QueryClientProvider } from '@tanstack/react-query'
import { createMemoryHistory, createRootRoute, createRoute, createRouter, RouterProvider } from '@tanstack/react-router'
import { act, isValidElement, type ReactElement, type ReactNode, useEffect, useId } from 'react'
import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { parse, stringify } from 'yaml'
import { run } from '../../tests/fixtures'
import { getRun } from '../api/calls'
import { Cache, catalogueQuery, libraryQuery, sessionQuery } from '../api/queries'
import type { Draft as StoredDraft } from '../client'
import { client } from '../client/client.gen'
import { EditRun } from '../run/header/EditRun'
import { Notes } from '../run/header/Notes'
import { Field, Form } from '../ui/Form'
import { DraftBar } from '../launch/draft/DraftBar'
import { LaunchPage } from '../launch/LaunchPage'
import { Estimate, RunCard } from '../launch/Side'
import { YamlEditor } from '../launch/YamlEditor'

/** An element with whatever it was given. */
type Given = ReactElement<Record<string, unknown>>
/** What a user does to an element. */
type Call = (...given: unknown[]) => unknown

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

const nothing = () => undefined
/** Waits, if need be on a busy machine. */
const until = <T,>(test: () => T) => vi.waitFor(test, { timeout: 30_000, interval: 5 })
const cache = new Cache({ defaultOptions: { queries: { retry: false } } })
let shown = new Map<string, ReactNode>()
let close: () => void = nothing
/** Fails until the router has done what it does. */
let settled: () => unknown = nothing

const all = () => [...shown.values()].flatMap(within)
const one = (test: (element: Given) => boolean): Given => {
  const found = all().find(test)
  if (!found) throw new Error('There is no such element.')
  return found
}
const of = (type: unknown, more: Record<string, unknown> = {}) =>
  one(({ type: own, props }) => own === type && Object.entries(more).every(([key, value]) => props[key] === value))
const call = (element: Given, name: string, ...given: unknown[]) => (element.props[name] as Call)(...given)

/** Shows a page; returns how to show it otherwise. Another key is another card. */
async function open(element: ReactElement, into: readonly string[] = [], around = (inner: ReactElement) => inner) {
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
let service: Record<string, (request: Request, body: string) => unknown> = {}
let asked: { what: string; match: string | null; body: unknown }[] = []
async function answered(request: Request): Promise<Response> {
  const body = await request.text()
  const what = `${request.method} ${new URL(request.url).pathname.slice('/api/v1/'.length)}`
  asked.push({ what, match: request.headers.get('If-Match'), body: /^[{]/.test(body) ? JSON.parse(body) : body })
  const answer = await service[what]?.(request, body)
  return answer instanceof Response ? answer : Response.json(answer ?? {}, { status: answer ? 200 : 404 })
}

const sent = (method: string) => asked.filter(({ what }) => what.startsWith(method)).map(({ body }) => body)
const patches = () => asked.filter(({ what }) => what.startsWith('PATCH'))

beforeEach(() => {
  shown = new Map()
  ;[service, asked, settled] = [{}, [], nothing]
  const frame = class {}
  const window = Object.assign(new EventTarget(), { setTimeout, clearTimeout, HTMLIFrameElement: frame, origin: 'http://service' })
  vi.stubGlobal('window', window)
  vi.stubGlobal('self', window)
  vi.stubGlobal('scrollTo', nothing)
  vi.stubGlobal('fetch', answered)
  client.setConfig({ baseUrl: 'http://service' })
  cache.setQueryData(sessionQuery.queryKey, { role: 'engineer', account: 'Ada' } as never)
})
afterEach(async () => {
  await until(settled)
  vi.stubGlobal('IS_REACT_ACT_ENVIRONMENT', true)
  act(close)
  await new Promise((done) => setTimeout(done)) // what queries told just before still arrives
  cache.clear()
  client.setConfig({ baseUrl: '' })
  vi.unstubAllGlobals()
})

const leaves = () => window.dispatchEvent(new Event('beforeunload', { cancelable: true }))
const write = (text: string) => call(of('textarea'), 'onChange', { target: { value: text } })
const text = (words: string) => all().some(({ props }) => props.children === words)
const press = (words: string) => call(one(({ props }) => props.children === words), 'onClick')
const send = () => call(of('form'), 'onSubmit', new Event('submit'))

it('keeps notes that are not saved when the run starts or ends, and what was read before', async () => {
  const show = await open(<Notes key="waits" run={run({ notes: 'old', state: 'queued' })} className="" />)
  press('Edit')
  await until(() => write('new'))
  await until(() => expect(leaves()).toBe(false))
  show(<Notes key="ended" run={run({ notes: 'theirs', state: 'done' })} className="" />)
  await until(() => expect(text('Written since:')).toBe(true))
  expect(of('textarea').props.value).toBe('new')
  send()
  await until(() => expect(sent('PATCH')).toEqual([{ notes: 'new', notes_before: 'old' }]))
})

it.each([['discarded', 'R-0002'], ['saved', 'R-0003']])('forgets notes that were %s, and lets the page be left', async (how, id) => {
  service[`PATCH runs/${id}`] = () => run({ id, notes: 'new' })
  const show = await open(<Notes key="waits" run={run({ id, notes: 'old' })} className="" />)
  press('Edit')
  await until(() => write('new'))
  await until(() => expect(leaves()).toBe(false))
  if (how === 'saved') send()
  else press('Discard')
  await until(() => expect(leaves()).toBe(true))
  show(<Notes key="ended" run={run({ id, notes: 'later' })} className="" />)
  await until(() => one(({ props }) => props.text === 'later'))
  expect(all().some(({ type }) => type === 'textarea')).toBe(false)
})

const read = (tag: string, name = 'one') => Response.json(run({ name, tags: ['a'] }), { headers: { ETag: tag } })
async function named() {
  service['GET runs/R-0001'] = () => read('"1"')
  const found = await getRun('R-0001')
  await open(<EditRun run={found} />, ['EditForm'])
  call(of('button', { 'aria-label': 'Change name and tags' }), 'onClick')
  await until(() => of(Form))
  asked = []
}

it('replaces the name and tags that were shown when the form was opened, not those that were read since', async () => {
  await named()
  service['GET runs/R-0001'] = () => read('"2"', 'theirs')
  await getRun('R-0001')
  service['PATCH runs/R-0001'] = () => read('"3"')
  asked = []
  call(of(Field, { label: 'Name' }), 'onChange', ' mine ')
  await until(() => expect(of(Field).props.value).toBe(' mine '))
  call(of(Form), 'onSend')
  await until(() => expect(patches()[0]).toEqual({ what: 'PATCH runs/R-0001', match: '"1"', body: { name: 'mine', tags: ['a'] } }))
  await until(() => expect(all().some(({ type }) => type === Form)).toBe(false))
  // The next form replaces what this one wrote.
  call(of('button', { 'aria-label': 'Change name and tags' }), 'onClick')
  await until(() => call(of(Form), 'onSend'))
  await until(() => expect(patches().at(-1)).toMatchObject({ what: 'PATCH runs/R-0001', match: '"3"' }))
})

it('pins a run whatever it was since it was read', async () => {
  await named()
  service['PATCH runs/R-0001'] = () => read('"2"')
  call(of('button', { 'aria-label': 'Pin this run to the top of the list' }), 'onClick')
  await until(() => expect(patches()[0]).toEqual({ what: 'PATCH runs/R-0001', match: null, body: { pinned: true } }))
})

it('sends a tag that was typed and not entered, and nothing with a name or tag that cannot be one', async () => {
  await named()
  const type = async (name: string, value: string) => {
    call(of(TagsInput), name, value)
    await until(() => expect(of(TagsInput).props.searchValue).toBe(value))
  }
  await type('onSearchChange', 'b/c')
  expect(of(Form).props.off).toBe(true)
  await type('onSearchChange', 'b a')
  expect(of(Form).props.off).toBe(false)
  call(of(Form), 'onSend')
  await until(() => expect(patches()[0]?.body).toEqual({ name: 'one', tags: ['a', 'b'] }))
  call(of(Field, { label: 'Name' }), 'onChange', '  ')
  await until(() => expect(of(Form).props.off).toBe(true))
})

const CATALOGUE = { version: 'test', components: [], methods: [], simulators: [], unusable: [] }
const TEXT = stringify(run().campaign)
const draft = (version: number, name: string): StoredDraft => ({
  id: 'D-0001', version, name, tags: [], owner: 'Ada', created: 0, saved: 0, saved_by: 'Ada', run: null, text: TEXT.replace('a campaign', name),
})
const checked = (_: Request, body: string) => {
  try {
    return { ok: true, problems: [], digest: '', document: parse(body) as unknown, yaml: body, parameters: [] }
  } catch {
    return { ok: false, problems: [{ field: '', given: '', message: 'not readable' }], digest: null, document: null, yaml: null, parameters: [] }
  }
}

async function launching(address: string) {
  Object.assign(service, { 'POST campaigns/check': checked, 'GET drafts': () => [], 'GET drafts/D-0001': () => draft(1, 'mine') })
  cache.setQueryData(catalogueQuery.queryKey, CATALOGUE)
  cache.setQueryData(libraryQuery.queryKey, [{ id: 'case', document: run().campaign, yaml: TEXT }] as never)
  await open(<LaunchPage />, ['Editor'], (inner) => {
    const root = createRootRoute()
    const page = createRoute({ getParentRoute: () => root, path: '/launch', component: () => inner })
    const router = createRouter({ routeTree: root.addChildren([page]), history: createMemoryHistory({ initialEntries: [address] }) })
    settled = () => expect(router.state.status).toBe('idle')
    return <RouterProvider router={router as never} />
  })
  await until(() => of(DraftBar))
}

const rename = (name: string) => call(of(RunCard), 'onName', name)
const nameNow = () => of(RunCard).props.name
const bar = () => of(DraftBar).props as unknown as Parameters<typeof DraftBar>[0]

it('counts what is typed while a draft is being saved as not saved', async () => {
  await launching('/launch?draft=D-0001')
  let answer: Call = nothing
  service['PUT drafts/D-0001'] = () => new Promise((done) => (answer = done))
  rename('second')
  await until(() => expect(bar().dirty).toBe(true))
  void bar().saved.save()
  await until(() => expect(sent('PUT')).toMatchObject([{ name: 'second', version: 1 }]))
  rename('third')
  await until(() => expect(nameNow()).toBe('third'))
  answer(draft(2, 'second'))
  await until(() => expect(bar().saved).toMatchObject({ saving: false, draft: { version: 2 } }))
  expect(bar().dirty).toBe(true)
  void bar().saved.save()
  await until(() => expect(sent('PUT')[1]).toMatchObject({ name: 'third', version: 2 }))
  answer(draft(3, 'third'))
  await until(() => expect(bar().dirty).toBe(false))
})

it.each([
  ['opened', '/launch?draft=D-0001'],
  ['saved', '/launch?case=case'],
])('opens what another user saved over a draft that was %s here', async (how, address) => {
  await launching(address)
  service['POST drafts'] = () => draft(1, 'mine')
  service['PUT drafts/D-0001'] = () => Response.json({ title: 'Overtaken' }, { status: 409 })
  if (how === 'saved') void bar().saved.save()
  await until(() => expect(bar()).toMatchObject({ dirty: false, saved: { draft: { version: 1 } } }))
  rename('second')
  await until(() => expect(bar().dirty).toBe(true))
  await expect(bar().saved.save()).rejects.toThrow('Overtaken')
  await until(() => expect(bar().saved.overtaken).toBe(true))
  service['GET drafts/D-0001'] = () => draft(2, 'theirs')
  bar().onReopen()
  await until(() => expect([nameNow(), bar().dirty, bar().saved.overtaken]).toEqual(['theirs', false, false]))
  service['PUT drafts/D-0001'] = () => draft(3, 'ours')
  rename('ours')
  await until(() => expect(bar().dirty).toBe(true))
  await bar().saved.save()
  expect(sent('PUT').at(-1)).toMatchObject({ name: 'ours', version: 2 })
})

it('has no form of a text that undoing brings back and that cannot be read', async () => {
  service['GET campaigns/schema'] = () => ({})
  await launching('/launch?draft=D-0001&tab=yaml')
  const shows = () => [of(YamlEditor).props.text, all().some(({ type }) => type === Estimate)]
  call(of(YamlEditor), 'onChange', '[', 'typed')
  await until(() => expect(shows()).toEqual(['[', false]))
  call(of(YamlEditor), 'onChange', TEXT, 'replaced')
  await until(() => expect(shows()).toEqual([TEXT, true]))
  call(of(YamlEditor), 'onUndo')
  await until(() => expect(shows()).toEqual(['[', false]))
  call(of(YamlEditor), 'onRedo')
  await until(() => expect(shows()).toEqual([TEXT, true]))
})
