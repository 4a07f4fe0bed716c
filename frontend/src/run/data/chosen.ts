// What a run's page shows beside the nominal flight, which instant of it from where, and how: it stands in the address,
// so that a copy shows the same.
import type { FindingDetail } from '../../client'
import { CAMERAS, type Camera } from './viewChange'

export const NOMINAL = 'nominal'

/** A finding's label, or the nominal flight. */
const LABEL = /^(F[1-9]\d{0,2}|nominal)$/

export interface ChosenSearch {
  /** A finding's label, or `nominal`; the worst one where there is none. */
  finding?: string
  /** Ranges in the parameter space, `path:from:to` each. */
  brush?: string[]
  /** The criterion that colours the parameter space, by its name; the one that decides where there is none. */
  by?: string
  /** The whole flight in the charts over time, not the encounter alone. */
  time?: 'all'
  /** Columns of the flight shown over time, with commas between; the usual ones where there is none. */
  columns?: string
  /** The instant that the 3D view opens at [s]; the closest approach where there is none. */
  t?: number
  /** From where it is looked at first. */
  cam?: Camera
  /** The what-if is open, and begins at these parameters: those of a finding, or `nominal`. */
  whatif?: string
  /** What it has otherwise, `path:value` each. */
  set?: string[]
  /** Its noise seed, where it has one of its own. */
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

/** The label of what is shown: as asked for where there is such a finding, otherwise the worst. */
export function chosenOf(asked: string | undefined, findings: readonly FindingDetail[]): string {
  if (asked === NOMINAL) return NOMINAL
  const known = findings.some((finding) => finding.label === asked)
  return asked && (known || findings.length === 0) ? asked : (findings[0]?.label ?? 'F1')
}

/** What a chosen flight is called in charts and tables. */
export const calledOf = (chosen: string): string => (chosen === 'F1' ? 'Worst' : chosen)
