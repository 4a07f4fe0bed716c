// Sets up the generated client, whose requests resolve with their data and reject with a `Refusal`; and requests that several
// parts of the pages make, or that need more than the client.

import type { CaseRequest, DraftContent, DraftReplace, FlightRequest, ListRunsData, ProposeSearchesData, RunEdit, RunSubmit, SweepSubmit, ViewChange } from '../client'
import * as sdk from '../client'
import { ROOT } from '../format/root'
import { client } from '../client/client.gen'
import { fetchOnce } from './ahead'
import type { Campaign } from './campaign'
import { refusalOf } from './problems'
import { pulse } from './pulse'

client.setConfig({ baseUrl: ROOT, fetch: (request) => pulse.follow(fetchOnce(request as Request)) })

client.interceptors.error.use(refusalOf)

/** Entity tags of runs as they were read last, for edits. */
const tags = new Map<string, string>()

client.interceptors.response.use((response, { url }) => {
  const run = /\/api\/v1\/runs\/(R-\d+)$/.exec(url)?.[1]
  const tag = response.ok && response.headers.get('ETag')
  if (run && tag) tags.set(run, tag)
  return response
})

export type RunFilter = Omit<NonNullable<ListRunsData['query']>, 'cursor' | 'limit'>

/** The API's OpenAPI document as JSON; parsed in `docs/openapi`. */
export const getOpenApi = () => client.get<unknown, unknown, true, 'data'>({ url: '/api/v1/openapi.json', responseStyle: 'data' })

export const listRuns = (filter: RunFilter, cursor: string | null, limit = 100) => sdk.listRuns({ query: { ...filter, limit, ...(cursor ? { cursor } : {}) } })

export const getRun = (run: string) => sdk.getRun({ path: { run } })
/** Its campaign as a file: the original text if it was submitted as text. */
export const getRunText = (run: string) => sdk.getRunCampaign({ path: { run }, parseAs: 'text' })
export const cancelRun = (run: string) => sdk.cancelRun({ path: { run } })
export const retryRun = (run: string) => sdk.retryRun({ path: { run } })
export const restartRun = (run: string) => sdk.restartRun({ path: { run } })
export const continueRun = (run: string) => sdk.continueRun({ path: { run } })
/** The entity tag of a run as it is shown now. */
export const tagOf = (run: string): string | undefined => tags.get(run)
/** A name or tags replace those with the tag; notes have their own check, and the pin is set whatever it was. */
export const editRun = (run: string, change: RunEdit, tag?: string) =>
  sdk.editRun({ path: { run }, body: change, headers: tag === undefined ? {} : { 'If-Match': tag } })

export const removeRuns = (runs: string[], reason: string) => sdk.removeRuns({ body: { runs, reason } })
export const restoreRuns = (runs: string[]) => sdk.restoreRuns({ body: { runs } })
export const getHistory = (run: string) => sdk.listHistory({ path: { run } })

/** A file that is generated on request, as a stream. */
export async function getFile(href: string): Promise<Blob> {
  const response = await fetch(href).catch(() => undefined)
  if (!response?.ok) throw refusalOf(await response?.json().catch(() => null), response)
  return response.blob()
}

/** The state of the 3D view that this page opened: now, or once it differs from a revision. */
export const getView = (
  run: string,
  key: string,
  signal?: AbortSignal,
  news?: { since: number; wait: number },
) => sdk.getView({ path: { run, key }, query: news, signal })
/** One flight of a run with other parameters; superseded by a newer request of the same client. */
export const simulateFlight = (run: string, body: FlightRequest) => sdk.simulateFlight({ path: { run }, body })

/** Evaluates one case of a run's simulator with other parameters. */
export const evaluateCase = (run: string, body: CaseRequest) => sdk.evaluateCase({ path: { run }, body })

/** Changes the 3D view; the service waits up to this many seconds for it to open. */
export const changeView = (
  run: string,
  key: string,
  body: ViewChange,
  wait: number,
  signal?: AbortSignal,
) => sdk.changeView({ path: { run, key }, body, query: { wait }, signal })

/** The JSON Schema of a campaign. */
export const getSchema = () => sdk.campaignSchema()

/** YAML text, sent as it is. */
const asText = (text: string) => ({ body: text as never, bodySerializer: null, headers: { 'Content-Type': 'application/yaml' } })

/** Checks a campaign, whose fields may be wrong yet, or its text: its parsed form, or its errors. */
export const checkCampaign = (campaign: Campaign | string, signal?: AbortSignal) =>
  sdk.checkCampaign({ ...(typeof campaign === 'string' ? asText(campaign) : { body: { campaign } }), signal })

/** The nominal flight of a campaign; a new combination of components is compiled first. */
export const previewCampaign = (campaign: Campaign, signal?: AbortSignal) => sdk.previewCampaign({ body: { campaign }, signal })

export type ProposalRequest = ProposeSearchesData['query'] & { simulator: string }

/** Search methods and budgets for a simulator, from what its evaluations took in the newest run of it. */
export const proposeSearches = ({ simulator, ...query }: ProposalRequest) => sdk.proposeSearches({ path: { name: simulator }, query })

export const createDraft = (body: DraftContent) => sdk.createDraft({ body })
export const saveDraft = (draft: string, body: DraftReplace) => sdk.saveDraft({ path: { draft }, body })
export const deleteDraft = (draft: string, version?: number) => sdk.deleteDraft({ path: { draft }, query: { version } })

/** Starts a run; the same key never starts a second one. */
export const submitRun = (body: RunSubmit, key: string) => sdk.submitRun({ body, headers: { 'Idempotency-Key': key } })

/** Launches a sweep; the same key never launches a second one. */
export const submitSweep = (body: SweepSubmit, key: string) => sdk.submitSweep({ body, headers: { 'Idempotency-Key': key } })
