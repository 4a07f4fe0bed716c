// The undo history of form and text, as changes of the text.
import type { Campaign } from '../../api/campaign'

/** A campaign's text, and the state of the form. */
export interface Version {
  text: string
  campaign: Campaign
}

interface Edit {
  from: number
  before: string
  after: string
  /** The state of the form before and after. */
  campaigns: [Campaign, Campaign]
}

export interface History {
  done: Edit[]
  undone: Edit[]
  /** The last edited field and time [ms]: continued typing is the same edit. */
  last: { what: string; at: number } | null
}

export const NOTHING: History = { done: [], undone: [], last: null }

const MOST = 500
const TOGETHER = 700

/** The single range in which two texts differ. */
export function stretch(before: string, after: string): { from: number; before: string; after: string } {
  const least = Math.min(before.length, after.length)
  let from = 0
  while (from < least && before[from] === after[from]) from++
  let tail = 0
  while (tail < least - from && before[before.length - 1 - tail] === after[after.length - 1 - tail]) tail++
  return { from, before: before.slice(from, before.length - tail), after: after.slice(from, after.length - tail) }
}

const put = (text: string, from: number, old: string, now: string): string =>
  text.slice(0, from) + now + text.slice(from + old.length)

/** Adds an edit. `what` identifies the field; successive edits of the same field within a short time are merged. */
export function recorded(history: History, was: Version, is: Version, what: string, at: number): History {
  const { done, last } = history
  const before = done.at(-1)
  const goesOn = before !== undefined && last?.what === what && at - last.at < TOGETHER && history.undone.length === 0
  const first: Version = goesOn
    ? { text: put(was.text, before.from, before.after, before.before), campaign: before.campaigns[0] }
    : was
  if (was.text === is.text) return history
  const edit: Edit = { ...stretch(first.text, is.text), campaigns: [first.campaign, is.campaign] }
  return { done: [...(goesOn ? done.slice(0, -1) : done).slice(-MOST), edit], undone: [], last: { what, at } }
}

/** Undoes one edit; null if there is none. */
export function undo(history: History, text: string): [History, Version] | null {
  const edit = history.done.at(-1)
  if (!edit) return null
  const next = { done: history.done.slice(0, -1), undone: [...history.undone, edit], last: null }
  return [next, { text: put(text, edit.from, edit.after, edit.before), campaign: edit.campaigns[0] }]
}

/** Redoes one edit; null if there is none. */
export function redo(history: History, text: string): [History, Version] | null {
  const edit = history.undone.at(-1)
  if (!edit) return null
  const next = { done: [...history.done, edit], undone: history.undone.slice(0, -1), last: null }
  return [next, { text: put(text, edit.from, edit.before, edit.after), campaign: edit.campaigns[1] }]
}
