// Targets of the search dialog besides runs: pages, library campaigns, and help topics.
import type { Catalogue, LibraryCampaign, RunSummary } from '../client'
import { GUIDES } from '../help/guides'
import { idOfComponent } from '../help/links'

export interface Place {
  /** An address of these pages. */
  to: string
  group: 'Pages' | 'Launch' | 'Help' | 'Guides' | 'API'
  name: string
  note: string
}

const PAGES: readonly Place[] = [
  { to: '/runs', group: 'Pages', name: 'Runs', note: 'All runs' },
  { to: '/launch', group: 'Pages', name: 'Launch', note: 'A new run' },
  { to: '/compare', group: 'Pages', name: 'Compare', note: 'Runs side by side' },
  { to: '/sweeps', group: 'Pages', name: 'Sweeps', note: 'Several values of one parameter' },
  { to: '/trends', group: 'Pages', name: 'Trends', note: 'A campaign over time' },
  { to: '/requirements', group: 'Pages', name: 'Requirements', note: 'The matrix of requirements and runs' },
  { to: '/reports', group: 'Pages', name: 'Reports', note: 'All reports, with sign-offs' },
  { to: '/help', group: 'Pages', name: 'Verdicts', note: 'What each of them means' },
  { to: '/help/methods', group: 'Pages', name: 'Search methods', note: 'What each of them guarantees' },
  { to: '/help/components', group: 'Pages', name: 'Components', note: 'Equations and sources' },
  { to: '/docs', group: 'Pages', name: 'API', note: 'For programs' },
]

/** All targets in their order. */
export function placesOf(library: readonly LibraryCampaign[], catalogue: Catalogue | undefined): Place[] {
  const campaigns = library.map(({ id, document }): Place => {
    const { name, summary } = document as { name?: string; summary?: string }
    return { to: `/launch?case=${encodeURIComponent(id)}`, group: 'Launch', name: name ?? id, note: summary ?? '' }
  })
  const methods = (catalogue?.methods ?? []).map(
    ({ name, title }): Place => ({ to: `/help/methods#${name}`, group: 'Help', name: title, note: 'Search method' }),
  )
  const components = (catalogue?.components ?? []).map(({ role, name, title, dimension }): Place => {
    const space = dimension ? `, ${dimension === 2 ? 'in the plane' : 'in space'}` : ''
    const note = role.charAt(0).toUpperCase() + role.slice(1) + space
    return { to: `/help/components#${idOfComponent(role, name)}`, group: 'Help', name: title, note }
  })
  const simulators = (catalogue?.simulators ?? []).map(
    ({ name, title }): Place => ({ to: `/help/components#${idOfComponent('simulator', name)}`, group: 'Help', name: title, note: 'Simulator' }),
  )
  const guides = GUIDES.map(({ name, title }): Place => ({ to: `/help/guides/${name}`, group: 'Help', name: title, note: 'Guide' }))
  return [...PAGES, ...campaigns, ...methods, ...components, ...simulators, ...guides]
}

const wordsOf = (text: string): string[] => text.toLowerCase().split(/\s+/).filter(Boolean)

/** Of the runs found for an earlier text, those that the text finds too: shown until the service has answered. */
export function kept(runs: readonly RunSummary[], text: string): RunSummary[] {
  const words = wordsOf(text)
  return runs.filter(({ id, name, campaign_name, tags }) => {
    const all = [id, name, campaign_name, ...tags].join(' ').toLowerCase()
    return words.every((word) => all.includes(word))
  })
}

/** The targets that contain every word, those whose names start with the text first; only pages for an empty text. */
export function matching(places: readonly Place[], text: string, most = 12): Place[] {
  const words = wordsOf(text)
  if (words.length === 0) return places.filter((place) => place.group === 'Pages')
  const rank = ({ name }: Place): number => {
    const lower = name.toLowerCase()
    if (lower.startsWith(words.join(' '))) return 0
    return words.every((word) => lower.includes(word)) ? 1 : 2
  }
  return places
    .filter((place) => words.every((word) => `${place.name} ${place.note}`.toLowerCase().includes(word)))
    .map((place, i) => ({ place, i, rank: rank(place) }))
    .sort((a, b) => a.rank - b.rank || a.i - b.i)
    .slice(0, most)
    .map(({ place }) => place)
}
