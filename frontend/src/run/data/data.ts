// Shared data of the cards of a run's page, and selectors.
import { useQuery, useQueryClient, type UseQueryResult } from '@tanstack/react-query'
import { useEffect, useMemo, useRef, useState } from 'react'
import { asCampaign, type Campaign, hasScenario } from '../../api/campaign'
import { useStreamStatus } from '../../api/events'
import {
  componentsQuery,
  evaluationsQuery,
  findingsQuery,
  isLive,
  stagesQuery,
  traceQuery,
  tracesQuery,
} from '../../api/queries'
import { resultWith } from '../../api/stages'
import type {
  Catalogue,
  EvaluationSeries,
  Evaluations,
  FindingDetail,
  RunDetail,
  SearchResult,
  StageDetail,
  StageProgress,
  TraceData,
  TraceInfo,
} from '../../client'
import { namesOf } from '../../format/names'
import { boundsOf, numberOf, parametersOf } from '../../launch/campaign/parameters'
import { methodLook } from '../../ui/methods'
import { usePolling } from '../../ui/usePolling'
import { chosenOf, NOMINAL, worstOf } from './chosen'
import { isSame, type MissingPart, missingOf } from './missing'

export interface UncertainParameter {
  path: string
  /** Its symbol, with its part of the campaign if others have the same one: y of obstacle 1. */
  symbol: string
  unit: string
  text: string
  nominal: number
  low: number
  high: number
}

export interface RunData {
  run: RunDetail
  campaign: Campaign
  /** The descriptions of its components and methods. */
  catalogue: Catalogue | undefined
  parameters: UncertainParameter[]
  stages: StageDetail[]
  evaluations: Evaluations | undefined
  findings: FindingDetail[]
  /** The stored flights without their data. */
  traces: TraceInfo[]
  nominalTrace: TraceData | undefined
  /** The flight shown with the nominal one: the label of a finding, or `nominal`. */
  chosen: string
  finding: FindingDetail | null
  findingTrace: TraceData | undefined
  /** Whether all data that determine the layout are loaded. */
  complete: boolean
  /** What could not be loaded. */
  missing: MissingPart[]
}

/** All data of a run's page; empty or undefined while loading. The same object as long as nothing in it changes. */
export function useRunData(run: RunDetail, label?: string): RunData {
  const over = !isLive(run)
  useFreshAtEnd(run.id, over)
  const components = useQuery(componentsQuery(run.id))
  const catalogue = components.data?.catalogue
  const stages = useQuery(stagesQuery(run.id))
  const evaluations = useQuery(evaluationsQuery(run.id))
  useMissed(run, evaluations)
  const findings = useQuery(findingsQuery(run.id))
  const traces = useQuery({ ...tracesQuery(run.id), enabled: over })
  const has = (name: string) => over && (traces.data ?? []).some((trace) => trace.name === name)
  const nominalTrace = useQuery({ ...traceQuery(run.id, 'nominal'), enabled: has('nominal') })
  const chosen = chosenOf(label, findings.data ?? [], worstOf(run))
  const findingTrace = useQuery({ ...traceQuery(run.id, chosen), enabled: chosen !== NOMINAL && has(chosen) })
  const campaign = useMemo(() => asCampaign(run.campaign), [run.campaign])
  const parameters = useMemo(() => uncertainOf(campaign, catalogue), [campaign, catalogue])
  return useStable({
    run,
    campaign,
    catalogue,
    parameters,
    stages: stages.data ?? NONE,
    evaluations: evaluations.data,
    findings: findings.data ?? NONE,
    traces: traces.data ?? NONE,
    nominalTrace: nominalTrace.data,
    chosen,
    finding: findings.data?.find((finding) => finding.label === chosen) ?? null,
    findingTrace: chosen === NOMINAL ? undefined : findingTrace.data,
    complete: [stages, findings, traces, nominalTrace, findingTrace].every((query) => !query.isLoading),
    missing: missingOf({ components, stages, findings, evaluations, traces, 'the nominal trace': nominalTrace, [`the trace of ${chosen}`]: findingTrace }),
  })
}

const NONE: never[] = []

/** The object of the last rendering if nothing in it has changed, so that what was rendered from it stays. */
function useStable(next: RunData): RunData {
  const [stable, setStable] = useState(next)
  const same = Object.entries(next).every(([key, value]) => key === 'missing' || stable[key as keyof RunData] === value)
  if (same && isSame(stable.missing, next.missing)) return stable
  setStable(next)
  return next
}

/** Polls for evaluations that the stream does not send. */
function useMissed(run: RunDetail, { data, refetch }: UseQueryResult<Evaluations>): void {
  const live = isLive(run)
  // The stream sends every improvement with its parameters. The rest is polled rarely, because a long search takes long to
  // read: the reasons of evaluations without a value, and what an improvement is by the other criteria.
  const streamed = useStreamStatus() === 'open'
  usePolling(refetch, 3000, live && !streamed)
  const missed = useRef(0)
  usePolling(
    () => {
      const more = missed.current !== missedOf(run) || data?.stages.some(({ cost, further }) => (cost.at(-1) ?? null) !== null && Object.values(further).some((values) => values.at(-1) === null))
      missed.current = missedOf(run)
      return more ? refetch() : undefined
    },
    10_000,
    live && streamed,
  )
}

/** Evaluations without a value, whose reasons the page lists. */
const missedOf = (run: RunDetail): number => run.stages.reduce((sum, stage) => sum + stage.failed + stage.excluded, 0)

/** Invalidates the run's data when it has ended, detected by stream or polling. */
function useFreshAtEnd(id: string, over: boolean): void {
  const cache = useQueryClient()
  const live = useRef(!over)
  useEffect(() => {
    if (live.current && over)
      for (const key of ['stages', 'evaluations', 'findings', 'traces', 'trace'])
        void cache.invalidateQueries({ queryKey: [key, id] })
    live.current = !over
  }, [cache, id, over])
}

/** The uncertain parameters in the campaign's order, as a catalogue describes them. */
export function uncertainOf(campaign: Campaign, catalogue: Catalogue | undefined): UncertainParameter[] {
  const all = catalogue ? parametersOf(campaign, catalogue) : []
  const known = new Map(all.map((p) => [p.path, p]))
  const symbols = new Map(all.map(({ path, entry }) => [path, entry.symbol]))
  const names = namesOf(Object.keys(campaign.uncertain), symbols)
  return Object.entries(campaign.uncertain).flatMap(([path, uncertain]) => {
    const parameter = known.get(path)
    const nominal = numberOf(parameter?.nominal)
    const [low, high] = boundsOf(uncertain, nominal).map(numberOf)
    if (typeof low !== 'number' || typeof high !== 'number') return []
    const { unit = uncertain.unit ?? '', text = path } = parameter?.entry ?? {}
    // Names must be unambiguous: two obstacles have the same symbols. Parameters of a simulator may have none.
    const symbol = parameter ? (names.get(path) ?? path) : path
    return [{ path, symbol, unit, text, nominal: nominal ?? (low + high) / 2, low, high }]
  })
}

export interface SearchStage {
  stage: StageProgress
  result: SearchResult | null
  series: EvaluationSeries | undefined
  title: string
}

/** The search stages with their data. */
export function searchesOf({
  run,
  stages,
  evaluations,
  catalogue,
}: Pick<RunData, 'run' | 'stages' | 'evaluations' | 'catalogue'>): SearchStage[] {
  return run.stages
    .filter((stage) => stage.method !== null)
    .map((stage) => {
      const result = resultWith(stages.filter((s) => s.position === stage.position), 'members')
      return {
        stage,
        result,
        series: evaluations?.stages.find((s) => s.position === stage.position),
        title: result?.title ?? catalogue?.methods.find((m) => m.name === stage.method)?.title ?? (stage.method ? methodLook(stage.method).title : ''),
      }
    })
}

/** Whether there are evaluations to show in the parameter space. */
export const hasSpace = ({ parameters, evaluations }: Pick<RunData, 'parameters' | 'evaluations'>): boolean =>
  parameters.length > 0 && evaluations !== undefined && evaluations.stages.some((stage) => stage.index.length > 0)

/** The best so far over evaluations or seconds; the last point shows the progress of the stage. */
export function convergenceOf(search: SearchStage, by: 'evaluations' | 'seconds'): { x: number[]; y: number[] } {
  const { index = [], seconds = [], cost = [] } = search.series?.improvements ?? {}
  const x: number[] = []
  const y: number[] = []
  let best = Number.POSITIVE_INFINITY
  index.forEach((at, i) => {
    best = Math.min(best, cost[i] ?? Number.POSITIVE_INFINITY)
    if (!Number.isFinite(best)) return
    x.push(by === 'evaluations' ? at + 1 : (seconds[i] ?? 0))
    y.push(best)
  })
  const total = by === 'evaluations' ? search.stage.evaluations : search.stage.seconds
  const last = x[x.length - 1]
  if (last !== undefined && total > last) {
    x.push(total)
    y.push(best)
  }
  return { x, y }
}

export interface Best {
  cost: number
  method: string | null
  parameters: Record<string, number>
  /** Values of all criteria, by name. */
  values: Record<string, number | null>
}

/** The lowest value so far with its parameters, if known, of the stages that ask the question of the campaign. */
export function bestOf({ evaluations, run }: Pick<RunData, 'evaluations' | 'run'>): Best | null {
  let best: Best | null = null
  const own = new Set(run.stages.filter((stage) => stage.own).map((stage) => stage.position))
  for (const series of evaluations?.stages.filter(({ position }) => own.has(position)) ?? []) {
    series.cost.forEach((cost, i) => {
      if (cost === null || (best && cost >= best.cost)) return
      const parameters = Object.fromEntries(Object.entries(series.parameters).map(([path, v]) => [path, v[i] ?? 0]))
      const further = Object.entries(series.further).map(([name, v]) => [name, v[i] ?? null] as const)
      const values = { [run.criteria[0]?.name ?? '']: cost, ...Object.fromEntries(further) }
      best = { cost, method: series.method, parameters, values }
    })
  }
  return best
}

/** The values of all criteria at a stored flight, by name; empty if not stored. */
export const valuesOf = (trace: TraceInfo | undefined): Record<string, number | null> =>
  trace?.meta.values ?? {}

/** The stage that has the lowest value so far. */
export function leaderOf(run: Pick<RunDetail, 'stages'>): StageProgress | null {
  const best = (stage: StageProgress) => stage.best ?? Number.POSITIVE_INFINITY
  return run.stages.filter((stage) => stage.own && stage.best !== null).sort((a, b) => best(a) - best(b))[0] ?? null
}

/** Whether the independent sample drew it: searches draw no noise for each evaluation. */
export const drawn = ({ validation }: Pick<FindingDetail, 'validation'>): boolean => validation?.realisation != null

/**
 * The method that found a finding: of the worst one, the method with the lowest value if it is among them; else the one that
 * needed the fewest evaluations. With several calls for an evaluation the lowest value may be a lucky one of another case.
 * None has found what the independent sample drew.
 */
export function finderOf({ run }: Pick<RunData, 'run'>, finding: FindingDetail): string | null {
  if (drawn(finding)) return null
  const found = [...finding.found].sort((a, b) => a.evaluations - b.evaluations)
  const methods = found.length > 0 ? found.map(({ method }) => method) : finding.methods
  if (finding.label === worstOf(run) && run.worst_method !== null && methods.includes(run.worst_method)) return run.worst_method
  return methods[0] ?? null
}

/** Evaluations per second of a stage, as measured; null if its time was too short to measure. */
export const rateOf = ({ evaluations, seconds }: Pick<StageProgress, 'evaluations' | 'seconds'>): number | null =>
  evaluations > 0 && seconds >= 0.05 ? evaluations / seconds : null

/** Whether the vehicle moves in space: "flight" is a word for aircraft only, not for a robot on the ground. */
export function leavesGround({ campaign, catalogue, nominalTrace }: Pick<RunData, 'campaign' | 'catalogue' | 'nominalTrace'>): boolean {
  if (!hasScenario(campaign)) return false
  const name = campaign.scenario.vehicle.component
  const vehicle = catalogue?.components.find((component) => component.role === 'vehicle' && component.name === name)
  return vehicle ? vehicle.dimension === 3 : nominalTrace?.meta.frame === 'ned'
}
