// The campaign document as edited by the form, and the location of a parameter's path in it.

export type Json = string | number | boolean | null | Json[] | { [key: string]: Json }
/** A field may contain text that is not a number; the service then reports the error next to it. */
export type Raw = number | string

export interface Part {
  component: string
  parameters?: Record<string, Raw>
  /** The vehicle input affected by an actuator fault. */
  on?: string
}

export interface Uncertain {
  low?: Raw | null
  high?: Raw | null
  plus_minus?: Raw | null
  unit?: string | null
  distribution?: { kind: string; mean?: Raw; deviation?: Raw; mode?: Raw; alpha?: Raw; beta?: Raw }
}

export interface SearchStage {
  method: string
  evaluations: Raw
  options?: Record<string, Json>
  starts?: Record<string, number>[]
}

export interface Correlation {
  between: string[]
  value: Raw
}

export interface Published {
  label: string
  value: number
  at?: Record<string, number>
  source?: string
}

/** Several calls of a simulator for each evaluation. */
export interface Repeats {
  count?: Raw
  combine?: string
  quantile?: Raw | null
}

/** A requirement that a criterion states; a file may give its id alone. */
export type Stated = string | { id?: string; text?: string } | null

/** A type, not an interface: requests take it as a document. */
export type Campaign = {
  version?: number
  name: string
  summary?: string
  notes?: string
  tags?: string[]
  scenario: {
    vehicle: Part
    controller: Part
    avoider: Part
    start?: Record<string, Raw>
    goal: Record<string, Raw>
    obstacles?: Part[]
    environment?: Part[]
    faults?: Part[]
    realisations?: { seeds?: Raw[]; combine?: string }
    guidance?: { period?: Raw }
    horizon: Raw
    step: Raw
  }
  /** Instead of a scenario. */
  simulator?: { name: string; parameters?: Record<string, Raw>; repeats?: Repeats | null; retries?: Raw }
  uncertain: Record<string, Uncertain>
  correlations?: Correlation[]
  criterion: { component: string; result?: string; parameters?: Record<string, Raw>; threshold: Raw; from_centre?: boolean; requirements?: Stated[] }
  objectives?: Part[]
  stages: {
    sensitivity?: {
      points: Raw
      morris?: { trajectories?: Raw; levels?: Raw } | null
      sobol?: { samples?: Raw } | null
    } | null
    search: SearchStage[]
    estimate?: { evaluations?: Raw } | null
    attraction?: { degree?: Raw } | null
    certify?: { samples?: Raw; quantile?: Raw; keep?: string; until?: string; grid?: { points: Raw } | null } | null
    findings?: { at_most?: Raw; evaluations?: Raw; distance?: Raw; barrier?: Raw }
    validate?: { tolerance?: Raw; neighbours?: Raw; reach?: Raw; evaluations?: Raw }
  }
  agreement?: Raw
  target_probability?: Raw | null
  confidence?: Raw
  seed?: Raw
  published?: Published[]
}

export const asCampaign = (document: unknown): Campaign => document as Campaign

/** Whether it has a scenario, in which something moves; a simulator returns values, and at most columns over time. */
export const hasScenario = (campaign: Campaign): boolean => !campaign.simulator

/** The word for what is evaluated: a flight, or a case of a simulator. */
export const caseWord = (campaign: Campaign): 'flight' | 'case' => (hasScenario(campaign) ? 'flight' : 'case')

/** The parts of a scenario that may occur any number of times. */
export const LISTS = ['obstacles', 'environment', 'faults'] as const
export type List = (typeof LISTS)[number]

/** The location of a list of parts in the document. */
export const listAt = (list: List | 'objectives'): string[] => (list === 'objectives' ? [list] : ['scenario', list])

/** The location of a parameter's nominal value in the document: `vehicle.m` -> scenario, vehicle, parameters, m. */
export function place(path: string): (string | number)[] {
  const [head = '', ...rest] = path.split('.')
  if (LISTS.some((list) => list === head))
    return ['scenario', head, Number(rest[0]), 'parameters', rest.slice(1).join('.')]
  const name = rest.join('.')
  if (head === 'objectives') return [head, Number(rest[0]), 'parameters', rest.slice(1).join('.')]
  if (head === 'criterion') return ['criterion', 'parameters', name]
  if (head === 'simulator') return ['simulator', 'parameters', name]
  if (head === 'start' || head === 'goal') return ['scenario', head, name]
  return ['scenario', head, 'parameters', name]
}

/** The name of that location in the service's problems. */
export const fieldOf = (path: string): string => place(path).join('.')

/** The value at a location of a document. */
export function read(document: unknown, at: readonly (string | number)[]): unknown {
  return at.reduce<unknown>(
    (value, key) => (value as Record<string | number, unknown> | null | undefined)?.[key],
    document,
  )
}

/** A copy of a document with one value changed; `undefined` removes it. Missing parents are created. */
export function write<T>(document: T, at: readonly (string | number)[], value: unknown): T {
  const [key, ...rest] = at
  if (key === undefined) return value as T
  const copy = (Array.isArray(document) ? [...document] : { ...document }) as Record<string | number, unknown>
  if (rest.length > 0) copy[key] = write(copy[key] ?? (typeof rest[0] === 'number' ? [] : {}), rest, value)
  else if (value === undefined) delete copy[key]
  else copy[key] = value
  return copy as T
}

/** The path of a parameter once a part of a list is removed; null if it is of that part. */
export function movedPath(path: string, list: List | 'objectives', index: number): string | null {
  const [head, number, ...rest] = path.split('.')
  if (head !== list || Number(number) < index) return path
  return Number(number) === index ? null : [head, Number(number) - 1, ...rest].join('.')
}

/** Removes one part of a list, with all references to it; the indices in later paths are decremented. */
export function without(campaign: Campaign, list: List | 'objectives', index: number): Campaign {
  const kept = <T>(values: Record<string, T>): Record<string, T> =>
    Object.fromEntries(
      Object.entries(values).flatMap(([path, value]) => {
        const now = movedPath(path, list, index)
        return now === null ? [] : [[now, value] as const]
      }),
    )
  const at = listAt(list)
  const parts = (read(campaign, at) as Part[]).filter((_, i) => i !== index)
  const { correlations, published, stages } = campaign
  const search = stages.search.map((stage) => (stage.starts ? { ...stage, starts: stage.starts.map(kept) } : stage))
  return {
    ...write(campaign, at, parts),
    uncertain: kept(campaign.uncertain),
    stages: { ...stages, search },
    ...(correlations && {
      correlations: correlations.flatMap((pair) => {
        const between = pair.between.map((path) => movedPath(path, list, index))
        return between.some((path) => path === null) ? [] : [{ ...pair, between: between as string[] }]
      }),
    }),
    ...(published && { published: published.map((one) => (one.at ? { ...one, at: kept(one.at) } : one)) }),
  }
}
