// The undo history of form and text, as versions of the text and of the form.
import type { Campaign } from '../../api/campaign'

/** A campaign's text, and the state of the form. */
export interface Version {
  text: string
  campaign: Campaign
}

export interface History {
  /** The versions before each edit, and after each edit that was undone. */
  done: Version[]
  undone: Version[]
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

/** Of what has more. */
const versionOf = ({ text, campaign }: Version): Version => ({ text, campaign })

/** Adds an edit. `what` identifies the field, '' one that is whole by itself; successive edits of the same field within
 * a short time are merged. */
export function recorded(history: History, was: Version, is: Version, what: string, at: number): History {
  const { done, undone, last } = history
  if (was.text === is.text) return history
  const goesOn = done.length > 0 && what !== '' && last?.what === what && at - last.at < TOGETHER && undone.length === 0
  return { done: goesOn ? done : [...done, versionOf(was)].slice(-MOST), undone: [], last: { what, at } }
}

/** Undoes one edit; null if there is none. */
export function undo({ done, undone }: History, is: Version): [History, Version] | null {
  const before = done.at(-1)
  return before ? [{ done: done.slice(0, -1), undone: [...undone, versionOf(is)], last: null }, before] : null
}

/** Redoes one edit; null if there is none. */
export function redo({ done, undone }: History, is: Version): [History, Version] | null {
  const after = undone.at(-1)
  return after ? [{ done: [...done, versionOf(is)], undone: undone.slice(0, -1), last: null }, after] : null
}
