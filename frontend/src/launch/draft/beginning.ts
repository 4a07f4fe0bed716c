// The initial state of an editor: a library campaign, an earlier run's, or the text of a draft.
import { checkCampaign, getRunText, getSchema } from '../../api/calls'
import { asCampaign, type Campaign } from '../../api/campaign'
import type { Draft, LibraryCampaign, RunDetail, Span } from '../../client'
import { textsOf } from '../regression/regression'
import { remedied } from './remedied'
import type { Beginning } from './useDraft'

export interface Start extends Beginning {
  name: string
  tags: string[]
  /** The draft as it was opened. */
  draft: Draft | null
  /** The changes of a run's campaign that its page proposed, as a phrase. */
  changed?: Span[]
  /** The labels of that run as KEY=VALUE, and its baseline as it was given. */
  labels?: string[]
  baseline?: string
}

export function fromLibrary(item: LibraryCampaign): Start {
  const campaign = asCampaign(item.document)
  return { campaign, text: item.yaml, readable: true, name: campaign.name, tags: campaign.tags ?? [], draft: null }
}

/** An earlier run's campaign; `remedy` names changes that its checks propose. */
export async function fromRun(run: RunDetail, remedy = ''): Promise<Start> {
  const own = { readable: true, name: run.name, tags: run.tags, draft: null, labels: textsOf(run.labels), baseline: run.baseline?.asked }
  const text = await getRunText(run.id)
  if (!remedy) return { ...own, campaign: plain(run.campaign), text }
  const { document, text: amended, statement } = await remedied(run, text, remedy)
  return { ...own, campaign: plain(document), text: amended, changed: statement }
}

/** Without the findings of the baseline, which belong to the launch of the run and not to its text. */
const plain = (document: unknown): Campaign => asCampaign({ ...(document as object), baseline: undefined })

/** A draft as it was saved, also in the form if possible. */
export async function fromDraft(draft: Draft, otherwise: Campaign): Promise<Start> {
  const own = { name: draft.name, tags: draft.tags, draft, text: draft.text }
  const { document } = await checkCampaign(draft.text)
  if (document) return { ...own, campaign: asCampaign(document), readable: true }
  const [{ formOf }, schema] = await Promise.all([import('../text'), getSchema()])
  const nearly = formOf(draft.text, schema)
  return { ...own, campaign: nearly ?? otherwise, readable: nearly !== null }
}
