// Undo and redo of edits in their order.
import { expect, it } from 'vitest'
import type { Campaign } from '../../api/campaign'
import { type History, NOTHING, recorded, redo, stretch, undo, type Version } from './history'

const version = (text: string): Version => ({ text, campaign: { name: text } as Campaign })

/** The successive texts, with field and time of each edit [ms]. */
const story = (...edits: [string, string, number][]): History => {
  let [history, was] = [NOTHING, version('a: 1')]
  for (const [text, what, at] of edits) {
    history = recorded(history, was, version(text), what, at)
    was = version(text)
  }
  return history
}

it('finds the stretch in which two texts differ', () => {
  expect(stretch('a: 1\nb', 'a: 2\nb')).toEqual({ from: 3, before: '1', after: '2' })
  expect(stretch('aa', 'aaa')).toEqual({ from: 2, before: '', after: 'a' })
  expect(stretch('same', 'same')).toEqual({ from: 4, before: '', after: '' })
})

it('takes edits back one by one and makes them again', () => {
  let history = story(['a: 12', 'a', 0], ['b: 12', 'text', 100], ['b: 3', 'a', 9000])
  let text = 'b: 3'
  for (const wanted of ['b: 12', 'a: 12', 'a: 1']) {
    const [next, is] = undo(history, version(text)) ?? [history, version('none')]
    expect(is).toEqual(version(wanted))
    ;[history, text] = [next, is.text]
  }
  expect(undo(history, version(text))).toBeNull()
  for (const wanted of ['a: 12', 'b: 12', 'b: 3']) {
    const [next, is] = redo(history, version(text)) ?? [history, version('none')]
    expect(is).toEqual(version(wanted))
    ;[history, text] = [next, is.text]
  }
  expect(redo(history, version(text))).toBeNull()
})

it('takes two removals for two edits, however soon the second follows', () => {
  const history = story(['b: 1', '', 0], ['c: 1', '', 100])
  expect(history.done.map(({ text }) => text)).toEqual(['a: 1', 'b: 1'])
})

it('takes what is typed at one go for one edit, and forgets what was taken back once there is another', () => {
  const history = story(['a: 12', 'a', 0], ['a: 123', 'a', 500], ['a: 1234', 'a', 900])
  const [back, is] = undo(history, version('a: 1234')) ?? [history, version('none')]
  expect(is.text).toBe('a: 1')
  const other = recorded(back, is, version('a: 7'), 'a', 1000)
  expect(redo(other, version('a: 7'))).toBeNull()
  expect(undo(other, version('a: 7'))?.[1].text).toBe('a: 1')
})
