// All requests of the pages, over the generated client: typed responses, `Refusal` for errors.

import type { CaseRequest, DraftContent, DraftReplace, FlightRequest, ListRunsData, ProposeSearchesData, RunDetail, RunEdit, RunSubmit, SignoffRequest, SweepSubmit, ViewChange } from '../client'
import * as sdk from '../client'
import { ROOT } from '../format/root'
import { client } from '../client/client.gen'
import { fetchOnce } from './ahead'
import type { Campaign } from './campaign'
import { refusalOf } from './problems'
import { pulse } from './pulse'

client.setConfig({ baseUrl: ROOT, fetch: (request) => pulse.follow(fetchOnce(request as Request)) })

interface Answer<T> {
  data?: T
  error?: unknown
  response?: Response
}

export async function answer<T>(request: Promise<Answer<T>>): Promise<T> {
  const { data, error, response } = await request
  if (!response?.ok) throw refusalOf(error, response)
  return data as T
}

export type RunFilter = Omit<NonNullable<ListRunsData['query']>, 'cursor' | 'limit'>

export const endSession = () => answer(sdk.endSession())
/** The API's OpenAPI document as JSON; parsed in `docs/openapi`. */
export const getOpenApi = (): Promise<unknown> =>
  answer(client.get<unknown>({ url: '/api/v1/openapi.json' }) as Promise<Answer<unknown>>)

export const listRuns = (filter: RunFilter, cursor: string | null, limit = 100) => answer(sdk.listRuns({ query: { ...filter, limit, ...(cursor ? { cursor } : {}) } }))

/** Entity tags of runs as they were read last, for edits. */
const tags = new Map<string, string>()

async function tagged(run: string, request: Promise<Answer<RunDetail>>): Promise<RunDetail> {
  const found = await answer(request)
  const tag = (await request).response?.headers.get('ETag')
  if (tag) tags.set(run, tag)
  return found
}

export const getRun = (run: string) => tagged(run, sdk.getRun({ path: { run } }))
/** Its campaign as a file: the original text if it was submitted as text. */
export const getRunText = (run: string) => answer(sdk.getRunCampaign({ path: { run }, parseAs: 'text' }))
export const cancelRun = (run: string) => answer(sdk.cancelRun({ path: { run } }))
export const retryRun = (run: string) => answer(sdk.retryRun({ path: { run } }))
export const restartRun = (run: string) => answer(sdk.restartRun({ path: { run } }))
export const continueRun = (run: string) => answer(sdk.continueRun({ path: { run } }))
/** The entity tag of a run as it is shown now. */
export const tagOf = (run: string): string | undefined => tags.get(run)
/** A name or tags replace those with the tag; notes have their own check, and the pin is set whatever it was. */
export const editRun = (run: string, change: RunEdit, tag?: string): Promise<RunDetail> =>
  tagged(run, sdk.editRun({ path: { run }, body: change, headers: tag === undefined ? {} : { 'If-Match': tag } }))

export const cancelRuns = (runs: string[]) => answer(sdk.cancelRuns({ body: { runs } }))
export const removeRuns = (runs: string[], reason: string) => answer(sdk.removeRuns({ body: { runs, reason } }))
export const restoreRuns = (runs: string[]) => answer(sdk.restoreRuns({ body: { runs } }))
export const getHistory = (run: string) => answer(sdk.listHistory({ path: { run } }))

export const getExports = (run: string) => answer(sdk.listExports({ path: { run } }))
/** A file that is generated on request, as a stream. */
export async function getFile(href: string): Promise<Blob> {
  const response = await fetch(href).catch(() => undefined)
  if (!response?.ok) throw refusalOf(await response?.json().catch(() => null), response)
  return response.blob()
}

/** Other runs of the same campaign, and those that differ only in the seed or the code. */
export const getRelated = (run: string) => answer(sdk.listRelated({ path: { run } }))
export const getTrend = (query: { campaign?: string; name?: string; label?: string[] }) => answer(sdk.getTrend({ query }))
export const listSweeps = () => answer(sdk.listSweeps())
export const getSweep = (sweep: string) => answer(sdk.getSweep({ path: { sweep } }))
export const cancelSweep = (sweep: string) => answer(sdk.cancelSweep({ path: { sweep } }))
export const listReports = (q: string, cursor: string | null) => answer(sdk.listReports({ query: { q, ...(cursor ? { cursor } : {}) } }))

export const getSignoffs = (run: string) => answer(sdk.listSignoffs({ path: { run } }))
export const signOff = (run: string, body: SignoffRequest) => answer(sdk.signOff({ path: { run }, body }))
export const withdrawSignoff = (run: string, signoff: number, reason: string) => answer(sdk.withdrawSignoff({ path: { run, signoff }, body: { reason } }))

/** The state of the 3D view that this page opened: now, or once it differs from a revision. */
export const getView = (
  run: string,
  key: string,
  signal?: AbortSignal,
  news?: { since: number; wait: number },
) => answer(sdk.getView({ path: { run, key }, query: news, signal }))
/** One flight of a run with other parameters; superseded by a newer request of the same client. */
export const simulateFlight = (run: string, body: FlightRequest) => answer(sdk.simulateFlight({ path: { run }, body }))

/** Evaluates one case of a run's simulator with other parameters. */
export const evaluateCase = (run: string, body: CaseRequest) => answer(sdk.evaluateCase({ path: { run }, body }))

/** Changes the 3D view; the service waits up to this many seconds for it to open. */
export const changeView = (
  run: string,
  key: string,
  body: ViewChange,
  wait: number,
  signal?: AbortSignal,
) => answer(sdk.changeView({ path: { run, key }, body, query: { wait }, signal }))

/** The JSON Schema of a campaign. */
export const getSchema = () => answer(sdk.campaignSchema())

/** YAML text, sent as it is. */
const asText = (text: string) => ({ body: text as never, bodySerializer: null, headers: { 'Content-Type': 'application/yaml' } })

/** Checks a campaign, whose fields may be wrong yet, or its text: its parsed form, or its errors. */
export const checkCampaign = (campaign: Campaign | string, signal?: AbortSignal) =>
  answer(sdk.checkCampaign({ ...(typeof campaign === 'string' ? asText(campaign) : { body: { campaign } }), signal }))

/** The nominal flight of a campaign; a new combination of components is compiled first. */
export const previewCampaign = (campaign: Campaign, signal?: AbortSignal) => answer(sdk.previewCampaign({ body: { campaign }, signal }))

export type ProposalRequest = ProposeSearchesData['query'] & { simulator: string }

/** Search methods and budgets for a simulator, from what its evaluations took in the newest run of it. */
export const proposeSearches = ({ simulator, ...query }: ProposalRequest) => answer(sdk.proposeSearches({ path: { name: simulator }, query }))

export const createDraft = (body: DraftContent) => answer(sdk.createDraft({ body }))
export const saveDraft = (draft: string, body: DraftReplace) => answer(sdk.saveDraft({ path: { draft }, body }))
export const deleteDraft = (draft: string, version?: number) => answer(sdk.deleteDraft({ path: { draft }, query: { version } }))

/** Starts a run; the same key never starts a second one. */
export const submitRun = (body: RunSubmit, key: string) => answer(sdk.submitRun({ body, headers: { 'Idempotency-Key': key } }))

/** Launches a sweep; the same key never launches a second one. */
export const submitSweep = (body: SweepSubmit, key: string) => answer(sdk.submitSweep({ body, headers: { 'Idempotency-Key': key } }))
