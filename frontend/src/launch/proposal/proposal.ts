// What a campaign asks for a proposal, and the searches that a proposal states. Nothing here needs the service.
import { DEFAULTS } from '../../api/rules'
import type { ProposalRequest } from '../../api/calls'
import type { Campaign, Json, SearchStage } from '../../api/campaign'
import type { Catalogue, Proposal } from '../../client'
import { parse } from '../../format/numbers'
import { numberOf } from '../campaign/parameters'

/** The limits of the service. */
const MOST = { minutes: 366 * 1440, calls: 1000, parameters: 64 }

/** The time of a text in minutes [min]; null if it is no time that a proposal can be made for. */
export function minutesOf(text: string): number | null {
  const minutes = parse(text)
  return minutes !== null && minutes > 0 && minutes <= MOST.minutes ? minutes : null
}

/** The request for a campaign; null while it names no simulator, no parameter to vary or an impossible number. */
export function requestOf(campaign: Campaign, minutes: number | null): ProposalRequest | null {
  const { name, repeats } = campaign.simulator ?? {}
  const parameters = Object.keys(campaign.uncertain).length
  const calls = repeats ? numberOf(repeats.count ?? DEFAULTS.count) : 1
  if (!name || minutes === null || parameters < 1 || parameters > MOST.parameters) return null
  if (calls === null || !Number.isInteger(calls) || calls < 1 || calls > MOST.calls) return null
  return { simulator: name, parameters, patience: 60 * minutes, calls }
}

/** The proposed searches as a campaign states them, in the order of the catalogue; methods that it lacks are left out. */
export function searchesOf(proposal: Proposal, catalogue: Catalogue): SearchStage[] {
  const order = catalogue.methods.map((method) => method.name)
  return proposal.searches
    .filter(({ method }) => order.includes(method))
    .toSorted((a, b) => order.indexOf(a.method) - order.indexOf(b.method))
    .map(({ method, evaluations, options }) => ({ method, evaluations, options: options as Record<string, Json>, starts: [] }))
}

/** Whether the campaign states these searches already; omitted options and starts are empty ones. */
export const stated = (campaign: Campaign, searches: readonly SearchStage[]): boolean =>
  JSON.stringify(campaign.stages.search.map(plain)) === JSON.stringify(searches.map(plain))

const plain = ({ method, evaluations, options, starts }: SearchStage) => [
  method,
  evaluations,
  Object.entries(options ?? {}).toSorted(([a], [b]) => a.localeCompare(b)),
  starts ?? [],
]
