// What an editor begins with: a campaign of the library, an earlier run's, or the text of a draft. Start: `fromText`.
import { checkCampaign } from '../api/calls'
import { asCampaign, type Campaign } from '../api/campaign'
import type { Draft, LibraryCampaign, RunDetail } from '../client'
import type { Beginning } from './useDraft'

export interface Start extends Beginning {
  name: string
  tags: string[]
  /** The draft that it is, as it was opened. */
  draft: Draft | null
}

export function fromLibrary(item: LibraryCampaign): Start {
  const campaign = asCampaign(item.document)
  return { campaign, text: item.yaml, source: 'form', name: campaign.name, tags: campaign.tags ?? [], draft: null }
}

export function fromRun(run: RunDetail): Start {
  const campaign = asCampaign(run.campaign)
  return { campaign, text: null, source: 'form', name: run.name, tags: run.tags, draft: null }
}

/** A draft as it was left: in the form where its text can be read or was the form's, else as text. */
export async function fromDraft(draft: Draft, otherwise: Campaign): Promise<Start> {
  const own = { name: draft.name, tags: draft.tags, draft }
  const { document } = await checkCampaign(draft.text)
  if (document) return { ...own, campaign: asCampaign(document), text: draft.text, source: 'form' }
  const typed = formOf(draft.text)
  if (typed) return { ...own, campaign: typed, text: null, source: 'form' }
  return { ...own, campaign: otherwise, text: draft.text, source: 'text' }
}

/** What the form left as JSON because something in it is no campaign yet; null for any other text. */
export function formOf(text: string): Campaign | null {
  try {
    const found: unknown = JSON.parse(text)
    return isForm(found) ? found : null
  } catch {
    return null
  }
}

const isMap = (value: unknown): value is Record<string, unknown> =>
  typeof value === 'object' && value !== null && !Array.isArray(value)

const isPart = (value: unknown): boolean => isMap(value) && typeof value.component === 'string'

/** Whether the form can show it: everything that it goes into is there. */
function isForm(value: unknown): value is Campaign {
  if (!isMap(value) || !isMap(value.scenario) || !isMap(value.uncertain) || !isMap(value.stages)) return false
  const { vehicle, controller, avoider, goal } = value.scenario
  const lists = [value.scenario.obstacles, value.scenario.environment, value.scenario.faults, value.objectives]
  return (
    [vehicle, controller, avoider, value.criterion].every(isPart) &&
    isMap(goal) &&
    Array.isArray(value.stages.search) &&
    lists.every((list) => list === undefined || (Array.isArray(list) && list.every(isPart)))
  )
}
