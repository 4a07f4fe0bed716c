// All requests of the pages, over the generated client: typed responses, `Refusal` for errors.

import type {
  Catalogue,
  Checked,
  Draft,
  DraftContent,
  DraftReplace,
  DraftSummary,
  Evaluations,
  ExportFile,
  FindingDetail,
  CaseAnswer,
  CaseInstalled,
  CaseRequest,
  FlightAnswer,
  FlightRequest,
  HistoryEntry,
  LibraryCampaign,
  ListRunsData,
  Preview,
  Proposal,
  CodeChanges,
  RelatedRuns,
  ReportPage,
  RunComponents,
  RunDetail,
  RunEdit,
  RunFacets,
  RunPage,
  RunSummary,
  SessionInfo,
  Signoff,
  SignoffRequest,
  Signoffs,
  SweepDetail,
  SweepSummary,
  StageDetail,
  TraceData,
  TraceInfo,
  Trend,
  ViewChange,
  ViewState,
  Workers,
} from '../client'
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

export const getSession = (): Promise<SessionInfo> => answer(sdk.getSession())
export const getWorkers = (): Promise<Workers> => answer(sdk.listWorkers())
export const endSession = (): Promise<unknown> => answer(sdk.endSession())
/** The API's OpenAPI document as JSON; parsed in `docs/openapi`. */
export const getOpenApi = (): Promise<unknown> =>
  answer(client.get<unknown>({ url: '/api/v1/openapi.json' }) as Promise<Answer<unknown>>)
export const getCatalogue = (): Promise<Catalogue> => answer(sdk.listComponents())
export const getLibrary = (): Promise<LibraryCampaign[]> => answer(sdk.listCampaigns())

export const listRuns = (filter: RunFilter, cursor: string | null, limit = 100): Promise<RunPage> =>
  answer(sdk.listRuns({ query: { ...filter, limit, ...(cursor ? { cursor } : {}) } }))

/** Entity tags of runs as they were read last, for edits. */
const tags = new Map<string, string>()

async function tagged(run: string, request: Promise<Answer<RunDetail>>): Promise<RunDetail> {
  const found = await answer(request)
  const tag = (await request).response?.headers.get('ETag')
  if (tag) tags.set(run, tag)
  return found
}

export const getRun = (run: string): Promise<RunDetail> => tagged(run, sdk.getRun({ path: { run } }))
/** Its campaign as a file: the original text if it was submitted as text. */
export const getRunText = (run: string): Promise<string> =>
  answer(sdk.getRunCampaign({ path: { run }, parseAs: 'text' }))
export const cancelRun = (run: string): Promise<RunSummary> => answer(sdk.cancelRun({ path: { run } }))
export const restartRun = (run: string): Promise<RunSummary> => answer(sdk.restartRun({ path: { run } }))
export const continueRun = (run: string): Promise<RunSummary> => answer(sdk.continueRun({ path: { run } }))
export const getFacets = (): Promise<RunFacets> => answer(sdk.listFacets())
export const editRun = (run: string, change: RunEdit): Promise<RunDetail> =>
  tagged(run, sdk.editRun({ path: { run }, body: change, headers: matching(run, change) }))

/** A name or tags replace those that were read; notes have their own check, and the pin is set whatever it was. */
function matching(run: string, change: RunEdit): { 'If-Match'?: string } {
  const tag = tags.get(run)
  return tag !== undefined && (change.name !== undefined || change.tags !== undefined) ? { 'If-Match': tag } : {}
}

export const cancelRuns = (runs: string[]): Promise<RunSummary[]> => answer(sdk.cancelRuns({ body: { runs } }))
export const removeRuns = (runs: string[], reason: string): Promise<RunSummary[]> =>
  answer(sdk.removeRuns({ body: { runs, reason } }))
export const restoreRuns = (runs: string[]): Promise<RunSummary[]> => answer(sdk.restoreRuns({ body: { runs } }))
export const getStages = (run: string): Promise<StageDetail[]> => answer(sdk.listStages({ path: { run } }))
/** The descriptions of its components, and their differences from this installation. */
export const getComponents = (run: string): Promise<RunComponents> => answer(sdk.listRunComponents({ path: { run } }))
/** The source files in which the code of a run differs from that of another one. */
export const getCodeChanges = (run: string, against: string): Promise<CodeChanges> =>
  answer(sdk.compareCode({ path: { run }, query: { against } }))
export const getHistory = (run: string): Promise<HistoryEntry[]> => answer(sdk.listHistory({ path: { run } }))
export const getFindings = (run: string): Promise<FindingDetail[]> => answer(sdk.listFindings({ path: { run } }))
export const getTraces = (run: string): Promise<TraceInfo[]> => answer(sdk.listTraces({ path: { run } }))

export const getExports = (run: string): Promise<ExportFile[]> => answer(sdk.listExports({ path: { run } }))
/** A file that is generated on request, as a stream. */
export async function getFile(href: string): Promise<Blob> {
  const response = await fetch(href).catch(() => undefined)
  if (!response?.ok) throw refusalOf(await response?.json().catch(() => null), response)
  return response.blob()
}

/** Other runs of the same campaign, and those that differ only in the seed or the code. */
export const getRelated = (run: string): Promise<RelatedRuns> => answer(sdk.listRelated({ path: { run } }))
export const getTrend = (query: { campaign?: string; name?: string; label?: string[] }): Promise<Trend> => answer(sdk.getTrend({ query }))
export const listSweeps = (): Promise<SweepSummary[]> => answer(sdk.listSweeps())
export const getSweep = (sweep: string): Promise<SweepDetail> => answer(sdk.getSweep({ path: { sweep } }))
export const cancelSweep = (sweep: string): Promise<SweepDetail> => answer(sdk.cancelSweep({ path: { sweep } }))
export const listReports = (q: string, cursor: string | null): Promise<ReportPage> =>
  answer(sdk.listReports({ query: { q, ...(cursor ? { cursor } : {}) } }))

export const getSignoffs = (run: string): Promise<Signoffs> => answer(sdk.listSignoffs({ path: { run } }))
export const signOff = (run: string, body: SignoffRequest): Promise<Signoff> => answer(sdk.signOff({ path: { run }, body }))
export const withdrawSignoff = (run: string, signoff: number, reason: string): Promise<Signoff> =>
  answer(sdk.withdrawSignoff({ path: { run, signoff }, body: { reason } }))

export const getEvaluations = (run: string): Promise<Evaluations> =>
  answer(sdk.getEvaluations({ path: { run }, query: { max_points: 2000 } }))

export const getTrace = (run: string, name: string, most = 1500): Promise<TraceData> =>
  answer(sdk.getTrace({ path: { run, name }, query: { max_points: most } }))

/** The state of the 3D view that this page opened: now, or once it differs from a revision. */
export const getView = (
  run: string,
  key: string,
  signal?: AbortSignal,
  news?: { since: number; wait: number },
): Promise<ViewState> => answer(sdk.getView({ path: { run, key }, query: news, signal }))
/** One flight of a run with other parameters; superseded by a newer request of the same client. */
export const simulateFlight = (run: string, body: FlightRequest, signal?: AbortSignal): Promise<FlightAnswer> =>
  answer(sdk.simulateFlight({ path: { run }, body, signal }))

/** Evaluates one case of a run's simulator with other parameters. */
export const evaluateCase = (run: string, body: CaseRequest, signal?: AbortSignal): Promise<CaseAnswer> =>
  answer(sdk.evaluateCase({ path: { run }, body, signal }))

/** Whether the machine of the service has the simulator of a run. */
export const getCaseInstalled = (run: string): Promise<CaseInstalled> => answer(sdk.caseInstalled({ path: { run } }))

/** Changes the 3D view; the service waits up to this many seconds for it to open. */
export const changeView = (
  run: string,
  key: string,
  body: ViewChange,
  wait: number,
  signal?: AbortSignal,
): Promise<ViewState> => answer(sdk.changeView({ path: { run, key }, body, query: { wait }, signal }))

/** Sends a campaign: the form's document, or YAML text. */
const post = <T>(url: string, given: Campaign | string, signal?: AbortSignal): Promise<T> =>
  answer(
    client.post<T>({
      url,
      body: typeof given === 'string' ? given : JSON.stringify({ campaign: given }),
      bodySerializer: null,
      headers: { 'Content-Type': typeof given === 'string' ? 'application/yaml' : 'application/json' },
      signal,
    }) as Promise<Answer<T>>,
  )

/** The JSON Schema of a campaign. */
export const getSchema = (): Promise<unknown> => answer(sdk.campaignSchema())

/** Checks a campaign: its parsed form, or its errors. */
export const checkCampaign = (given: Campaign | string, signal?: AbortSignal): Promise<Checked> =>
  post('/api/v1/campaigns/check', given, signal)

/** The nominal flight of a campaign; a new combination of components is compiled first. */
export const previewCampaign = (given: Campaign, signal?: AbortSignal): Promise<Preview> =>
  post('/api/v1/campaigns/preview', given, signal)

/** Search methods and budgets for a simulator, from what its evaluations took in the newest run of it. */
export const proposeSearches = ({
  simulator,
  ...query
}: {
  simulator: string
  parameters: number
  patience: number
  calls: number
}): Promise<Proposal> => answer(sdk.proposeSearches({ path: { name: simulator }, query }))

export const listDrafts = (): Promise<DraftSummary[]> => answer(sdk.listDrafts())
export const getDraft = (draft: string): Promise<Draft> => answer(sdk.getDraft({ path: { draft } }))
export const createDraft = (body: DraftContent): Promise<Draft> => answer(sdk.createDraft({ body }))
export const saveDraft = (draft: string, body: DraftReplace): Promise<Draft> =>
  answer(sdk.saveDraft({ path: { draft }, body }))
export const deleteDraft = (draft: string, version?: number): Promise<unknown> =>
  answer(sdk.deleteDraft({ path: { draft }, query: { version } }))

export interface Submission {
  campaign: Campaign
  name: string
  tags: string[]
  labels: Record<string, string>
  /** A run, or label:KEY=VALUE. */
  baseline: string | null
  /** The original text of the campaign. */
  text: string
}

/** Starts a run; the same key never starts a second one. */
export const submitRun = (submission: Submission, key: string): Promise<RunSummary> =>
  answer(
    client.post<RunSummary>({
      url: '/api/v1/runs',
      body: JSON.stringify(submission),
      bodySerializer: null,
      headers: { 'Content-Type': 'application/json', 'Idempotency-Key': key },
    }) as Promise<Answer<RunSummary>>,
  )

export interface SweepRequest {
  campaign: Campaign
  /** A parameter that is not uncertain. */
  path: string
  values: number[]
  name: string
  tags: string[]
  labels: Record<string, string>
}

/** Launches a sweep; the same key never launches a second one. */
export const submitSweep = (request: SweepRequest, key: string): Promise<SweepDetail> =>
  answer(
    client.post<SweepDetail>({
      url: '/api/v1/sweeps',
      body: JSON.stringify(request),
      bodySerializer: null,
      headers: { 'Content-Type': 'application/json', 'Idempotency-Key': key },
    }) as Promise<Answer<SweepDetail>>,
  )
