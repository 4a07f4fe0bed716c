// What a run has to show, and how much room that needs: the conditions of the sections of its page.
import { hasScenario } from '../api/campaign'
import { type MinimaResult, randomSample, resultsWith, resultWith, type SlicesResult } from '../api/stages'
import type { Blocks, GridResult, Sample, ValidateResult } from '../client'
import { type Best, bestOf, hasSpace, type RunData } from './data/data'
import { hasView } from './flight/declared'
import { overTime } from './flight/flown'

export interface Facts {
  /** Whether a scenario is simulated; otherwise a simulator is evaluated. */
  flies: boolean
  /** Whether there is a 3D view: a simulator is drawn if its trace states what is where. */
  drawn: boolean
  /** Whether the nominal flight is stored. */
  flown: boolean
  /** Whether a case can be shown next to the nominal one. */
  shown: boolean
  /** Whether there is a time series: a finding may have a trace although the nominal case has none. */
  timed: boolean
  /** Shown without a validated finding, labelled as not validated. */
  lowest: Best | null
  sensitivity: SlicesResult | null
  grid: GridResult | null
  /** Of a sample of which only a part is stored. */
  blocks: Blocks | null
  validation: ValidateResult | null
  /** The searches that found minima from their starts; null if none did. */
  minima: { position: number; search: MinimaResult }[] | null
  front: boolean
  searched: boolean
  methods: number
  sample: Sample | null
  /** Whether a certify stage drew the sample. */
  certified: boolean
  space: boolean
  /** Number of published values, once there is a verdict. */
  published: number
  /** Whether the sensitivity fits next to the separation: two charts do, more need their own row. */
  few: boolean
  /** Whether the tornado fits next to the flight, below a short table. */
  raised: boolean
  /** Whether the minima by start need their own row, because of their many parameters. */
  many: boolean
}

export function factsOf(data: RunData): Facts {
  const { run, findings, parameters, campaign, nominalTrace, findingTrace } = data
  const flies = hasScenario(campaign)
  const flown = flies && nominalTrace !== undefined
  const lowest = findings.length > 0 ? null : bestOf(data)
  const shown = flown || findings.length > 0 || lowest !== null
  const sensitivity = resultWith(data.stages, 'curves')
  const minima = data.stages.flatMap((stage) => {
    const search = resultWith([stage], 'minima')
    return search && search.minima.length > 0 ? [{ position: stage.position, search }] : []
  })
  return {
    flies,
    drawn: hasView(data),
    flown,
    shown,
    timed: overTime(nominalTrace ?? (flies ? undefined : findingTrace)).length > 0,
    lowest,
    sensitivity,
    grid: resultWith(data.stages, 'grid')?.grid ?? null,
    blocks: resultWith(data.stages, 'blocks')?.blocks ?? null,
    validation: resultWith(data.stages, 'comparison'),
    minima: minima.length > 0 ? minima : null,
    front: resultsWith(data.stages, 'front').some(({ front }) => front?.length),
    searched: run.stages.some((stage) => stage.method !== null && stage.evaluations > 0),
    methods: run.stages.filter((stage) => stage.method !== null).length,
    sample: randomSample(data.stages),
    certified: resultWith(data.stages, 'grid') !== null,
    space: hasSpace(data),
    published: run.verdict ? (campaign.published?.length ?? 0) : 0,
    few: sensitivity !== null && sensitivity.curves.length <= 2 && flown,
    raised: sensitivity !== null && parameters.length + run.criteria.length <= 4 && shown,
    many: parameters.length > 3,
  }
}
