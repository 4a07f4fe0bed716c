// The state of a run's page in the address: chosen flight, instant, camera, and display options, so that a copied link
// shows the same.
import type { FindingDetail, RunDetail } from '../../client'
import { CAMERAS, type Camera } from './viewChange'

export const NOMINAL = 'nominal'

/** A finding's label, or the nominal flight. */
const LABEL = /^(F[1-9]\d{0,2}|nominal)$/

export interface ChosenSearch {
  /** A finding's label, or `nominal`; the worst one by default. */
  finding?: string
  /** Ranges in the parameter space, `path:from:to` each. */
  brush?: string[]
  /** The name of the criterion that colours the parameter space; the deciding one by default. */
  by?: string
  /** Show the whole flight in charts over time, not only the encounter. */
  time?: 'all'
  /** Columns of the flight shown over time, comma-separated; the default ones if absent. */
  columns?: string
  /** Initial time of the 3D view [s]; the closest approach by default. */
  t?: number
  /** Initial camera. */
  cam?: Camera
  /** The reference of the open what-if: a finding, or `nominal`. */
  whatif?: string
  /** Its changed values, `path:value` each. */
  set?: string[]
  /** Its own noise seed, if any. */
  noise?: number
}

export function readChosen(search: Record<string, unknown>): ChosenSearch {
  const { finding, brush, by, time, columns, t, cam, whatif, set, noise } = search
  const seed = typeof noise === 'string' && /^\d{1,15}$/.test(noise) ? Number(noise) : noise
  const values = [set].flat().filter((value) => typeof value === 'string' && /^[\w.#]+:[-+\d.eE]+$/.test(value)) as string[]
  const at = typeof t === 'string' && t !== '' ? Number(t) : t
  const ranges = [brush].flat().filter((range) => typeof range === 'string' && /^[\w.#]+:\S+:\S+$/.test(range)) as string[]
  return {
    ...(typeof finding === 'string' && LABEL.test(finding) ? { finding } : {}),
    ...(ranges.length > 0 ? { brush: ranges } : {}),
    ...(typeof by === 'string' && /^\w+(#\d+)?$/.test(by) ? { by } : {}),
    ...(time === 'all' ? { time } : {}),
    ...(typeof columns === 'string' && /^[\w.]+(,[\w.]+)*$/.test(columns) ? { columns } : {}),
    ...(typeof at === 'number' && at >= 0 && at < 1e6 ? { t: at } : {}),
    ...(CAMERAS.includes(cam as Camera) ? { cam: cam as Camera } : {}),
    ...(typeof whatif === 'string' && LABEL.test(whatif) ? { whatif } : {}),
    ...(values.length > 0 ? { set: values } : {}),
    ...(typeof seed === 'number' && Number.isSafeInteger(seed) && seed >= 0 ? { noise: seed } : {}),
  }
}

/** The label of the worst finding: the one that the verdict names, of a violated run the worst that is confirmed. */
export const worstOf = ({ summary }: Pick<RunDetail, 'summary'>): string => summary?.worst?.finding ?? 'F1'

/** The label of the displayed finding: the requested one if it exists, else the worst. */
export function chosenOf(label: string | undefined, findings: readonly FindingDetail[], worst: string): string {
  if (label === NOMINAL) return NOMINAL
  const known = findings.some((finding) => finding.label === label)
  return label && (known || findings.length === 0) ? label : worst
}

/** The title of a chosen flight in charts and tables. */
export const calledOf = ({ run, chosen }: { run: Pick<RunDetail, 'summary'>; chosen: string }): string =>
  chosen === worstOf(run) ? 'Worst' : chosen
