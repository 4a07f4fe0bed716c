// What the search dialog finds besides names: sections of the guides by their text, and operations of the API.
import { type OpenApi, operationsOf } from '../docs/openapi'
import { fragmentOf, GUIDES } from '../help/guides'
import type { Place } from './places'

/** A target with the text that is searched besides its name, in paragraphs. */
export interface Passage extends Place {
  texts: readonly string[]
}

/** Length of an excerpt. */
const EXCERPT = 90

/** Sections of the guides, by file name as `import.meta.glob` gives them. */
export function sectionsIn(files: Readonly<Record<string, string>>): Passage[] {
  return GUIDES.flatMap(({ name, title }) => {
    const text = Object.entries(files).find(([file]) => file.endsWith(`/${name}.md`))?.[1] ?? ''
    const parts = text.split(/^(?=```|#{1,4} )/m)
    const found: { heading: string; texts: string[] }[] = []
    let fenced = false
    for (const part of parts) {
      const heading = fenced ? undefined : /^#{1,4} (.+)\n?/.exec(part)
      if (part.startsWith('```')) fenced = !fenced
      if (heading) found.push({ heading: plain(heading[1] ?? ''), texts: [] })
      found.at(-1)?.texts.push(...part.slice(heading?.[0].length ?? 0).split(/\n\s*\n|\n(?=[|-] )/).map(plain).filter(Boolean))
    }
    return found.map(({ heading, texts }, i): Passage => ({
      to: `/help/guides/${name}${i === 0 ? '' : `#${fragmentOf(heading)}`}`,
      group: 'Guides',
      name: heading,
      note: title,
      texts,
    }))
  })
}

/** The operations of the API, by method, path and the first sentence of their description. */
export function operationsIn(document: OpenApi | undefined): Passage[] {
  const all = document ? operationsOf(document).flatMap((group) => group.operations) : []
  return all.map(({ operationId, method, path, description = '' }) => ({
    to: `/docs#${operationId}`,
    group: 'API',
    name: `${method.toUpperCase()} ${path.replace('/api/v1', '')}`,
    note: plain(description.split(/(?<=\.)\s/)[0] ?? ''),
    texts: [plain(description)],
  }))
}

/** Those that contain every word: in the name first, then in most paragraphs, then anywhere. The note is a paragraph. */
export function passagesWith(passages: readonly Passage[], text: string, most = 6): Place[] {
  const words = text.trim().split(/\s+/).filter((word) => word.length > 1).map(stem)
  if (words.length === 0) return []
  const all = (passage: string): boolean => words.every((word) => word.test(passage))
  return passages
    .map((passage) => {
      const those = passage.texts.filter(all)
      const inOne = those[0]
      const named = all(passage.name)
      const rank = named ? 0 : inOne !== undefined ? 1 : all(`${passage.name} ${passage.texts.join(' ')}`) ? 2 : 3
      const first = inOne ?? (named ? passage.texts[0] : passage.texts.find((one) => words.some((word) => word.test(one)))) ?? ''
      const note = passage.group === 'Guides' ? `${passage.note}: ${excerpt(first, words)}` : passage.note
      return { place: { ...passage, note }, rank, count: those.length }
    })
    .filter(({ rank }) => rank < 3)
    .sort((a, b) => a.rank - b.rank || b.count - a.count)
    .slice(0, most)
    .map(({ place: { to, group, name, note } }) => ({ to, group, name, note }))
}

/** Matches a word in its other numbers and endings as well: retries, retry, retried. */
function stem(word: string): RegExp {
  const escaped = (text: string): string => text.replaceAll(/[.*+?^${}()|[\]\\/-]/g, String.raw`\$&`)
  const y = word.length > 4 ? /^(.+?)(?:ies|ied|y)$/i.exec(word)?.[1] : undefined
  const plural = word.length > 3 ? /^(.+[^s])s$/i.exec(word)?.[1] : undefined
  return new RegExp(y ? `${escaped(y)}(?:y|ies|ied)` : escaped(plural ?? word), 'i')
}

/** Markdown as words. */
const plain = (text: string): string =>
  text
    .replaceAll(/<!--.*?-->/gs, ' ')
    .replaceAll(/^```.*$|^\|[-:| ]+\|$/gm, ' ')
    .replaceAll(/!?\[([^\]]*)\]\([^)]*\)/g, '$1')
    .replaceAll(/[`*|]|^\s*(?:-{3,}|[-#>] )/gm, ' ')
    .replaceAll(/\s+/g, ' ')
    .trim()

/** The part of a paragraph around the first word that is found. */
function excerpt(text: string, words: readonly RegExp[]): string {
  const at = Math.min(...words.map((word) => text.search(word)).filter((k) => k >= 0))
  if (text.length <= EXCERPT || !Number.isFinite(at) || at < EXCERPT / 2) return text.slice(0, 2 * EXCERPT)
  const begin = text.indexOf(' ', at - EXCERPT / 3) + 1
  return `… ${text.slice(Math.min(begin, at), at + 2 * EXCERPT)}`
}
