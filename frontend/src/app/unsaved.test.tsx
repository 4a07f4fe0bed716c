// A draft that is not saved yet: it is saved over what was read, and not lost to a change from elsewhere.
import { createMemoryHistory, createRootRoute, createRoute, createRouter, RouterProvider } from '@tanstack/react-router'
import { afterEach, beforeEach, expect, it } from 'vitest'
import { parse, stringify } from 'yaml'
import { run } from '../../tests/fixtures'
import { all, type Call, begin, cache, call, end, nothing, of, open, sent, service, settledOnce, until } from '../../tests/looked'
import { catalogueQuery, libraryQuery } from '../api/queries'
import type { Draft as StoredDraft } from '../client'
import { DraftBar } from '../launch/draft/DraftBar'
import { LaunchPage } from '../launch/LaunchPage'
import { Estimate, RunCard } from '../launch/Side'
import { YamlEditor } from '../launch/YamlEditor'

beforeEach(begin)
afterEach(end)

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
    settledOnce(() => expect(router.state.status).toBe('idle'))
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

it('saves as a new one what belongs to a draft that was deleted', async () => {
  await launching('/launch?draft=D-0001')
  service['PUT drafts/D-0001'] = () => Response.json({ title: 'Deleted' }, { status: 404 })
  service['POST drafts'] = () => ({ ...draft(1, 'second'), id: 'D-0002' })
  rename('second')
  await until(() => expect(bar().dirty).toBe(true))
  await expect(bar().saved.save()).rejects.toThrow('Deleted')
  await until(() => expect(bar().saved).toMatchObject({ overtaken: true, gone: true }))
  await bar().saved.save()
  await until(() => expect([bar().dirty, bar().saved.draft?.id]).toEqual([false, 'D-0002']))
})
