// Sentences of the service as in print: symbols for paths of parameters, true minus signs, narrow spaces before units.
// Start reading at `pieces`.
import { MINUS, NARROW } from './numbers'
import { unitText } from './units'

export interface Term {
  /** As it stands in sentences: d_min, vehicle.m */
  written: string
  symbol: string
}

export type Piece = { text: string } | Term

const escaped = (text: string): string => text.replace(/[.*+?^${}()|[\]\\]/g, '\\$&')

/** A sentence in pieces: what is a term by itself, and the words between. `units` are those that numbers may have. */
export function pieces(sentence: string, terms: readonly Term[], units: readonly string[] = []): Piece[] {
  const words = (text: string): Piece => ({ text: typeset(text, units) })
  if (terms.length === 0) return [words(sentence)]
  const longest = [...terms].sort((a, b) => b.written.length - a.written.length)
  const pattern = new RegExp(`(?<![\\w.])(${longest.map((term) => escaped(term.written)).join('|')})(?!\\w|\\.\\w)`)
  return sentence.split(pattern).flatMap((part, i) => {
    if (i % 2 === 0) return part === '' ? [] : [words(part)]
    return [longest.find((term) => term.written === part) ?? { text: part }]
  })
}

/** Numbers and units of plain text as in print. */
export function typeset(text: string, units: readonly string[]): string {
  const signs = text.replace(/(?<![\w.\u2212-])-(?=\d)|(?<=\de)-(?=\d)/g, MINUS)
  const known = [...new Set([...units, '%'])].filter(Boolean).sort((a, b) => b.length - a.length)
  const pattern = new RegExp(`(?<=\\d) (${known.map(escaped).join('|')})(?![\\w/])`, 'g')
  return signs.replace(pattern, (_, unit: string) => `${NARROW}${unitText(unit)}`)
}
