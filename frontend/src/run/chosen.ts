// Which flight a run's page shows beside the nominal one, a finding or none, and which instant of it from where. It
// stands in the address.
import type { FindingDetail } from '../client'
import { CAMERAS, type Camera } from './view'

export const NOMINAL = 'nominal'

export interface ChosenSearch {
  /** A finding's label, or `nominal`; the worst one where there is none. */
  finding?: string
  /** Ranges in the parameter space, `path:from:to` each. */
  brush?: string[]
  /** The instant that the 3D view opens at [s]; the closest approach where there is none. */
  t?: number
  /** From where it is looked at first. */
  cam?: Camera
}

export function readChosen(search: Record<string, unknown>): ChosenSearch {
  const { finding, brush, t, cam } = search
  const time = typeof t === 'string' && t !== '' ? Number(t) : t
  const ranges = [brush].flat().filter((range) => typeof range === 'string' && /^[\w.]+:\S+:\S+$/.test(range)) as string[]
  return {
    ...(typeof finding === 'string' && /^(F[1-9]\d{0,2}|nominal)$/.test(finding) ? { finding } : {}),
    ...(ranges.length > 0 ? { brush: ranges } : {}),
    ...(typeof time === 'number' && time >= 0 && time < 1e6 ? { t: time } : {}),
    ...(CAMERAS.includes(cam as Camera) ? { cam: cam as Camera } : {}),
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
