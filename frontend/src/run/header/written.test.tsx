// Notes, name and tags that are not saved yet: they are kept, and saved over what was read.
import { TagsInput } from '../../overlay/later'
import { afterEach, beforeEach, expect, it } from 'vitest'
import { run } from '../../../tests/fixtures'
import { all, asked, begin, type Call, call, end, leaves, nothing, of, one, open, patches, press, send, sent, service, text, until, write } from '../../../tests/looked'
import { getRun } from '../../api/calls'
import { Field, Form } from '../../ui/Form'
import { IconButton } from '../../ui/IconButton'
import { EditRun } from './EditRun'
import { Notes } from './Notes'

beforeEach(begin)
afterEach(end)

it('keeps notes that are not saved when the run starts or ends, and what was read before', async () => {
  const show = await open(<Notes key="waits" run={run({ notes: 'old', state: 'queued' })} className="" />, ['NotesCard'])
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
  const show = await open(<Notes key="waits" run={run({ id, notes: 'old' })} className="" />, ['NotesCard'])
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
  call(of(IconButton, { label: 'Change name and tags' }), 'act')
  await until(() => of(Form))
  asked.length = 0
}

it('replaces the name and tags that were shown when the form was opened, not those that were read since', async () => {
  await named()
  service['GET runs/R-0001'] = () => read('"2"', 'theirs')
  await getRun('R-0001')
  service['PATCH runs/R-0001'] = () => read('"3"')
  asked.length = 0
  call(of(Field, { label: 'Name' }), 'onChange', ' mine ')
  await until(() => expect(of(Field).props.value).toBe(' mine '))
  call(of(Form), 'onSend')
  await until(() => expect(patches()[0]).toEqual({ what: 'PATCH runs/R-0001', match: '"1"', body: { name: 'mine', tags: ['a'] } }))
  await until(() => expect(all().some(({ type }) => type === Form)).toBe(false))
  // The next form replaces what this one wrote.
  call(of(IconButton, { label: 'Change name and tags' }), 'act')
  await until(() => call(of(Form), 'onSend'))
  await until(() => expect(patches().at(-1)).toMatchObject({ what: 'PATCH runs/R-0001', match: '"3"' }))
})

it('pins a run whatever it was since it was read', async () => {
  await named()
  service['PATCH runs/R-0001'] = () => read('"2"')
  call(of(IconButton, { label: 'Pin this run to the top of the list' }), 'act')
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

it('names what another user has written where a change is refused, and sends it again once that is read', async () => {
  await named()
  service['PATCH runs/R-0001'] = () => Response.json({ title: 'Changed', detail: 'changed since' }, { status: 412 })
  service['GET runs/R-0001'] = () => read('"2"', 'theirs')
  call(of(Field, { label: 'Name' }), 'onChange', 'mine')
  await until(() => expect(of(Field).props.value).toBe('mine'))
  await getRun('R-0001')
  call(of(Form), 'onSend')
  await until(() => expect(patches()).toHaveLength(1))
  await until(() => press('I have read it; keep mine'))
  service['PATCH runs/R-0001'] = () => read('"3"', 'mine')
  await until(() => expect(text('I have read it; keep mine')).toBe(false))
  call(of(Form), 'onSend')
  await until(() => expect(patches()[1]).toMatchObject({ match: '"2"', body: { name: 'mine' } }))
})

it('never shows what was typed on one run as the notes of another', async () => {
  const show = await open(<Notes run={run({ id: 'R-0101', notes: '' })} className="" />, ['NotesCard'])
  press('Write')
  await until(() => write('of the first'))
  await until(() => expect(leaves()).toBe(false))
  show(<Notes run={run({ id: 'R-0102', notes: '' })} className="" />)
  await until(() => expect(all().some(({ type }) => type === 'textarea')).toBe(false))
  show(<Notes run={run({ id: 'R-0101', notes: '' })} className="" />)
  await until(() => expect(of('textarea').props.value).toBe('of the first'))
})

it.each([
  ['goes on with what is typed while notes are being saved', 'R-0201', 'first', 'first and more', true],
  ['is done once the notes are saved, whichever card of the run sent them', 'R-0202', 'first', 'first', false],
])('%s', async (_, id, saved, typed, writing) => {
  let answer: Call = nothing
  service[`PATCH runs/${id}`] = () => new Promise((done) => (answer = done))
  const show = await open(<Notes key="waits" run={run({ id, notes: '' })} className="" />, ['NotesCard'])
  press('Write')
  await until(() => write(saved))
  await until(() => expect(of('textarea').props.value).toBe(saved))
  send()
  await until(() => expect(sent('PATCH')).toEqual([{ notes: saved, notes_before: '' }]))
  if (typed === saved) show(<Notes key="ended" run={run({ id, notes: '', state: 'done' })} className="" />)
  else write(typed)
  await until(() => expect(of('textarea').props.value).toBe(typed))
  answer(run({ id, notes: saved }))
  show(<Notes key={typed === saved ? 'ended' : 'waits'} run={run({ id, notes: saved, state: 'done' })} className="" />)
  await until(() => expect(all().some(({ type }) => type === 'textarea')).toBe(writing))
  expect(text('Written since:')).toBe(false)
  await until(() => expect(leaves()).toBe(!writing))
})
