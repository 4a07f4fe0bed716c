// The states of a sweep's runs in words.
import { LIVE } from '../api/queries'
import { count } from '../format/numbers'

/** How many runs have not ended. */
export const activeOf = (states: Record<string, number>): number => LIVE.reduce((sum, state) => sum + (states[state] ?? 0), 0)

/** "2 queued, 1 running, 3 cleared, of these 1 contradicted": verdicts in place of "done". */
export function statementOf(states: Record<string, number>): string {
  const order = [...LIVE, 'cleared', 'contradicted', 'violated', 'inconclusive', 'cancelled', 'failed', 'purged']
  return order.flatMap((word) => (states[word] ? [`${word === 'contradicted' ? 'of these ' : ''}${count(states[word])} ${word}`] : [])).join(', ')
}
