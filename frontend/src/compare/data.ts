// Shared data of the cards of the compare page: each run with its letter, dash pattern and data.
import { useQueries } from '@tanstack/react-query'
import { asCampaign, hasScenario } from '../api/campaign'
import { componentsQuery, evaluationsQuery, findingsQuery, runQuery, stagesQuery, traceQuery } from '../api/queries'
import type { Catalogue, Evaluations, FindingDetail, RunDetail, StageDetail, TraceData } from '../client'
import { worstOf } from '../run/data/chosen'
import { uncertainOf, type UncertainParameter } from '../run/data/data'
import { type Parts, partsOf } from './matching'
import { DASHES, LETTERS } from './search'

export interface Compared {
  id: string
  letter: string
  dash: readonly number[]
  run: RunDetail
  stages: StageDetail[]
  findings: FindingDetail[]
  evaluations: Evaluations | undefined
  nominal: TraceData | undefined
  worst: TraceData | undefined
  /** The descriptions of its components and methods. */
  catalogue: Catalogue | undefined
  parameters: UncertainParameter[]
  parts: Parts
}

export interface Comparison {
  runs: Compared[]
  /** The runs that cannot be shown, with reasons. */
  missing: { id: string; error: Error }[]
  loading: boolean
  /** Why some results of the runs shown are not there. */
  failed: Error | null
  retry: () => void
}

export function useCompared(ids: readonly string[]): Comparison {
  const runs = useQueries({ queries: ids.map(runQuery) })
  const known = ids.filter((_, i) => runs[i]?.data)
  const stages = useQueries({ queries: known.map(stagesQuery) })
  const findings = useQueries({ queries: known.map(findingsQuery) })
  const evaluations = useQueries({ queries: known.map(evaluationsQuery) })
  const traced = known.filter(
    (id, i) => hasScenario(asCampaign(runs[ids.indexOf(id)]?.data?.campaign)) && stages[i]?.data?.some((stage) => stage.evaluations > 0),
  )
  const nominal = useQueries({ queries: known.map((id) => traceOf(id, 'nominal', traced.includes(id))) })
  const worst = useQueries({ queries: known.map((id) => traceOf(id, worstOf(runs[ids.indexOf(id)]?.data ?? { summary: null }), traced.includes(id))) })
  const components = useQueries({ queries: known.map(componentsQuery) })
  const needed = [...runs, ...stages, ...findings, ...evaluations, ...components]
  return {
    failed: needed.slice(runs.length).find((query) => query.isError && !query.data)?.error ?? null,
    retry: () => needed.filter((query) => query.isError).forEach((query) => void query.refetch()),
    loading: runs.some((query) => query.isPending),
    missing: ids.flatMap((id, i) => {
      const error = runs[i]?.data ? null : runs[i]?.error
      return error ? [{ id, error }] : []
    }),
    runs: known.flatMap((id, i) => {
      const at = ids.indexOf(id)
      const run = runs[at]?.data
      if (!run) return []
      const flown = traced.includes(id)
      const parameters = uncertainOf(asCampaign(run.campaign), components[i]?.data?.catalogue)
      return {
        id,
        letter: LETTERS[at] ?? '',
        dash: DASHES[at] ?? [],
        run,
        stages: stages[i]?.data ?? [],
        findings: findings[i]?.data ?? [],
        evaluations: evaluations[i]?.data,
        nominal: (flown && nominal[i]?.data) || undefined,
        worst: (flown && worst[i]?.data) || undefined,
        catalogue: components[i]?.data?.catalogue,
        parameters,
        parts: partsOf(asCampaign(run.campaign), parameters.map(({ path }) => path)),
      }
    }),
  }
}

/** A flight that may not be stored, which is not an error here. `traced`: whether its system flies; a simulator's trace
 * that the run's page loaded is in the cache all the same. */
const traceOf = (id: string, name: string, traced: boolean) => ({ ...traceQuery(id, name), enabled: traced, retry: false })

/** The description of a parameter in the first run that has it. */
export const parameterOf = (runs: readonly Compared[], path: string): UncertainParameter | undefined =>
  runs.flatMap(({ parameters }) => parameters.find((p) => p.path === path) ?? [])[0]

/** The common unit of all runs; null if units differ, so that differences are undefined. */
export function unitOf(runs: readonly Compared[]): string | null {
  const [first] = runs
  if (!first) return null
  const same = runs.every(({ run }) => run.unit === first.run.unit && run.quantity === first.run.quantity)
  return same ? first.run.unit : null
}

/** Whether a run has ended with all that it computes; the numbers of any other are of an incomplete search. */
export const isDone = (of: Compared | undefined): boolean => of?.run.state === 'done'

/** Whether there are differences to state: of two runs that are done, with the same quantity. */
export const haveDifferences = (runs: readonly Compared[]): boolean =>
  runs.length === 2 && unitOf(runs) !== null && runs.every(isDone)
