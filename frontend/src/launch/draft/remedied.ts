// The campaign of a run with the changes of remedies, as a document and as the text that was written by hand.
import { type Json, read } from '../../api/campaign'
import { statementOf, type Step, stepsIn } from '../../api/steps'
import type { RunDetail, Span } from '../../client'
import { applied, type Change } from '../text/changes'

export interface Remedied {
  document: Json
  text: string
  /** What was changed, as a phrase; empty if the address names no remedy of this run. */
  statement: Span[]
}

export async function remedied(run: RunDetail, text: string, keys: string): Promise<Remedied> {
  const steps = stepsIn(keys, run.summary?.checks ?? [])
  const { amended } = await import('../text')
  return {
    document: changed(run.campaign, steps),
    text: amended(text, changesFor(run.campaign, steps)),
    statement: statementOf(steps),
  }
}

export const changed = (document: unknown, steps: readonly Step[]): Json =>
  changesFor(document, steps).reduce<Json>(applied, document as Json)

/** The changes in the terms of the text; a location just behind the end of a list is a new entry. */
export function changesFor(document: unknown, steps: readonly Step[]): Change[] {
  let before = document as Json
  return steps.flatMap(({ remedy }) =>
    remedy.changes.map(({ at, value }) => {
      const list = read(before, at.slice(0, -1))
      const added = Array.isArray(list) && at.at(-1) === list.length
      const change: Change = added
        ? { kind: 'insert', at, value: value as Json }
        : { kind: 'set', at, value: value as Json, before: [] }
      before = applied(before, change)
      return change
    }),
  )
}
