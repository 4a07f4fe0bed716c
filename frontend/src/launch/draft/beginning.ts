// The initial state of an editor: a library campaign, an earlier run's, or the text of a draft.
import { checkCampaign, getRunText, getSchema } from '../../api/calls'
import { asCampaign, type Campaign } from '../../api/campaign'
import type { Draft, LibraryCampaign, RunDetail } from '../../client'
import type { Beginning } from './useDraft'

export interface Start extends Beginning {
  name: string
  tags: string[]
  /** The draft as it was opened. */
  draft: Draft | null
}

export function fromLibrary(item: LibraryCampaign): Start {
  const campaign = asCampaign(item.document)
  return { campaign, text: item.yaml, readable: true, name: campaign.name, tags: campaign.tags ?? [], draft: null }
}

export async function fromRun(run: RunDetail): Promise<Start> {
  const campaign = asCampaign(run.campaign)
  const text = await getRunText(run.id)
  return { campaign, text, readable: true, name: run.name, tags: run.tags, draft: null }
}

/** A draft as it was saved, also in the form if possible. */
export async function fromDraft(draft: Draft, otherwise: Campaign): Promise<Start> {
  const own = { name: draft.name, tags: draft.tags, draft, text: draft.text }
  const { document } = await checkCampaign(draft.text)
  if (document) return { ...own, campaign: asCampaign(document), readable: true }
  const [{ formOf }, schema] = await Promise.all([import('../text'), getSchema()])
  const nearly = formOf(draft.text, schema)
  return { ...own, campaign: nearly ?? otherwise, readable: nearly !== null }
}
