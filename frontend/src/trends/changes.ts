// Where the code changed within a trend, in words.
import type { TrendRun } from '../client'
import { namesOf } from './code'

const MOST = 3

export function changesOf(runs: readonly Pick<TrendRun, 'id' | 'code_changed' | 'code_changes' | 'code'>[]): string {
  const changed = runs.filter((run) => run.code_changed).map(({ id, code_changes: names }) => `${id} (${namesOf(names)})`)
  if (changed.length > 0) {
    const named = changed.length > MOST ? `${changed.slice(-MOST).join(', ')} and ${changed.length - MOST} earlier` : changed.join(', ')
    return `The code changed before ${named}`
  }
  return runs.every(({ code }) => code) ? 'All runs used the same code' : 'No change of the code is known'
}
