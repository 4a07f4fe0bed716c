// Sentences of the service as spans; converts a clause to a sentence.
import type { Span } from '../client'

export const words = (text: string): Span => ({ kind: 'text', text })

/** Adds a capital letter, if it starts with a word, and a full stop. */
export function sentence(statement: readonly Span[]): Span[] {
  if (statement.length === 0) return []
  const [first, ...rest] = statement as [Span, ...Span[]]
  const begun = first.kind === 'text' ? [words(first.text.charAt(0).toUpperCase() + first.text.slice(1)), ...rest] : [...statement]
  const last = begun.at(-1)
  return last?.kind === 'text' && last.text.endsWith('.') ? begun : [...begun, words('.')]
}
