// Filters the campaigns of the library by tag and words.
import { asCampaign, type Campaign } from '../../api/campaign'
import type { Catalogue, LibraryCampaign } from '../../client'
import { tally } from '../../format/names'

export interface Shelf {
  /** Null: all. */
  tag: string | null
  words: string
  /** Whether more than the first few are shown. */
  whole: boolean
}

/** Number of cards initially shown: two rows in a wide window. */
export const FEW = 10

const FIRST = 'published'

/** Published studies first, by case, then the others. */
export function ordered(campaigns: LibraryCampaign[]): LibraryCampaign[] {
  const key = (item: LibraryCampaign) => {
    const tags = asCampaign(item.document).tags ?? []
    const number = Number(/\d+/.exec(tags.find((tag) => /^case-\d+$/.test(tag)) ?? '')?.[0] ?? 1e6)
    return [tagged(item, FIRST) ? 0 : 1, number] as const
  }
  return [...campaigns].sort((a, b) => {
    const [x, y] = [key(a), key(b)]
    return x[0] - y[0] || x[1] - y[1]
  })
}

/** Published case studies, unless the chosen one is not published. */
export function shelfOf(campaigns: LibraryCampaign[], chosen: string | null): Shelf {
  const published = campaigns.filter((item) => tagged(item, FIRST))
  const fits = published.length > 0 && (chosen === null || published.some((item) => item.id === chosen))
  return { tag: campaigns.length > FEW && fits ? FIRST : null, words: '', whole: false }
}

/** The tags of the library with counts: published, kinds, then cases. */
export function tagsOf(campaigns: LibraryCampaign[]): { tag: string; count: number }[] {
  const counts = tally(campaigns.flatMap((item) => asCampaign(item.document).tags ?? []))
  const rank = (tag: string) => (tag === FIRST ? 0 : /\d/.test(tag) ? 2 : 1)
  return [...counts]
    .map(([tag, count]) => ({ tag, count }))
    .sort((a, b) => rank(a.tag) - rank(b.tag) || a.tag.localeCompare(b.tag, 'en', { numeric: true }))
}

/** The campaigns with that tag that contain every word in name, summary, tags or parts. */
export function matching(
  campaigns: LibraryCampaign[],
  { tag, words }: Pick<Shelf, 'tag' | 'words'>,
  catalogue: Catalogue | undefined,
): LibraryCampaign[] {
  const wanted = words.toLowerCase().split(/\s+/).filter(Boolean)
  return campaigns.filter((item) => {
    if (tag !== null && !tagged(item, tag)) return false
    const campaign = asCampaign(item.document)
    const parts = [...titlesOf(campaign, catalogue), ...(campaign.scenario.faults ?? []).map((part) => part.component)]
    const text = [item.id, campaign.name, campaign.summary ?? '', ...(campaign.tags ?? []), ...parts].join(' ')
    return wanted.every((word) => text.toLowerCase().includes(word))
  })
}

const tagged = (item: LibraryCampaign, tag: string): boolean => (asCampaign(item.document).tags ?? []).includes(tag)

/** The titles of vehicle, controller and avoider. */
export function titlesOf(campaign: Campaign, catalogue: Catalogue | undefined): string[] {
  return (['vehicle', 'controller', 'avoider'] as const).map((role) => {
    const name = campaign.scenario[role].component
    return catalogue?.components.find((c) => c.role === role && c.name === name)?.title ?? name
  })
}
