// The states of a sweep's runs in words.
import { count } from '../format/numbers'

const ACTIVE = ['queued', 'running', 'cancelling'] as const

/** How many runs have not ended. */
export const activeOf = (states: Record<string, number>): number => ACTIVE.reduce((sum, state) => sum + (states[state] ?? 0), 0)

/** "2 queued, 1 running, 3 cleared, of these 1 contradicted": verdicts in place of "done". */
export function statementOf(states: Record<string, number>): string {
  const order = ['queued', 'running', 'cancelling', 'cleared', 'contradicted', 'violated', 'inconclusive', 'cancelled', 'failed', 'purged']
  return order.flatMap((word) => (states[word] ? [`${word === 'contradicted' ? 'of these ' : ''}${count(states[word])} ${word}`] : [])).join(', ')
}
