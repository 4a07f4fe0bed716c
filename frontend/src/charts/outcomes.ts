// Outcomes of runs over a value or over time, as charts and texts. A run that is not done has no numbers.
import type { Outcome } from '../client'
import { boundText } from '../format/counts'
import { confidenceText, decimalsFor, fixed, margin, plain, probability } from '../format/numbers'
import { outcomeOf, shownAs, type Outcome as Word, wordOf } from '../ui/VerdictBadge'
import type { Line, PlotSpec, Point } from './spec'

/** A position on the horizontal axis and the run there; null if its results were purged. */
export interface At {
  x: number
  run: string
  outcome: Outcome | null
}

export type Kind = Word | 'contradicted' | 'purged'

export function kindOf(outcome: Outcome | null): Kind {
  if (!outcome) return 'purged'
  return shownAs(outcome) === outcomeOf(outcome) ? outcomeOf(outcome) : 'contradicted'
}

/** The kinds among the runs, each once, in a fixed order. */
const ORDER: readonly Kind[] = ['cleared', 'contradicted', 'violated', 'inconclusive', 'queued', 'running', 'cancelling', 'cancelled', 'failed', 'purged']
export const kindsOf = (points: readonly At[]): Kind[] =>
  ORDER.filter((kind) => points.some(({ outcome }) => kindOf(outcome) === kind))

/** Whether a run has no worst margin, so that only its position is marked. */
export const isBare = ({ outcome }: At): boolean => outcome?.margin === null || outcome?.margin === undefined

/** Colour and shape: cleared and violated are filled, contradicted and inconclusive are hollow; a violation is below the criterion. */
const COLOUR: Partial<Record<Kind, string>> = { cleared: '--ok-solid', violated: '--bad-solid', contradicted: '--unk-solid', inconclusive: '--unk-solid' }

/** The unit and symbol of the runs, if all that are done share them. */
export function commonOf(points: readonly At[]): { quantity: string; unit: string } | null {
  const done = points.flatMap(({ outcome }) => (outcome?.state === 'done' ? [outcome] : []))
  const first = done[0]
  if (!first) return { quantity: '', unit: '' }
  const same = done.every(({ quantity, unit }) => quantity === first.quantity && unit === first.unit)
  return same ? { quantity: first.quantity, unit: first.unit } : null
}

/** The horizontal axis; `rules` mark changes between runs. */
export type Axis = Pick<PlotSpec, 'xTitle' | 'xText' | 'xTicks' | 'xTime' | 'rules'>

/** The ends of the horizontal axis, with room beyond the outermost runs. */
function rangeOf(points: readonly At[]): [number, number] {
  const xs = points.map(({ x }) => x)
  const [low, high] = [Math.min(...xs), Math.max(...xs)]
  const room = high > low ? 0.04 * (high - low) : 0.5 * Math.abs(low) || 0.5
  return [low - room, high + room]
}

/** What both charts have; the position of a run without a worst margin is marked. */
const chartOf = (points: readonly At[], axis: Axis, height: number, sync: string) => ({
  ...axis,
  x: points.map(({ x }) => x),
  xRange: rangeOf(points),
  rules: [...(axis.rules ?? []), ...points.filter(isBare).map(({ x }) => ({ x, colour: '--c-axis' }))],
  height,
  sync,
})

/** The worst margins; null if no run has one. */
export function marginsOf(points: readonly At[], axis: Axis, height: number, sync: string): PlotSpec | null {
  const margins = points.map(({ outcome }) => outcome?.margin ?? null)
  const common = commonOf(points)
  if (!common || margins.every((margin) => margin === null)) return null
  const decimals = decimalsFor(margins)
  return {
    ...chartOf(points, axis, height, sync),
    label: `Worst margin of ${points.length} runs`,
    lines: [{ key: 'margin', label: 'Worst margin', colour: '--c-nom', y: margins, dots: true }],
    points: points.flatMap(({ x, outcome }): Point[] => {
      const kind = kindOf(outcome)
      if (outcome?.margin === null || outcome?.margin === undefined) return []
      return [{ x, y: outcome.margin, colour: COLOUR[kind] ?? '--c-nom', hollow: kind === 'contradicted' || kind === 'inconclusive' }]
    }),
    criterion: { value: 0, label: 'Criterion: margin 0', tint: true },
    yText: (y) => `${margin(y, decimals)} ${common.unit}`.trim(),
  }
}

/** The bounds on P(violation) and the observed fractions, in percent; null if no run has a sample. */
export function boundsOf(points: readonly At[], axis: Axis, height: number, sync: string): PlotSpec | null {
  const part = (value: number | null | undefined) => (value === null || value === undefined ? null : 100 * value)
  const bounds = points.map(({ outcome }) => part(outcome?.upper_bound))
  if (bounds.every((bound) => bound === null)) return null
  const observed = points.map(({ outcome }) => part(fractionOf(outcome)))
  const highest = Math.max(...bounds.map((bound) => bound ?? 0), ...observed.map((fraction) => fraction ?? 0))
  const lines: Line[] = [
    { key: 'bound', label: boundName(points), colour: '--c-bound', y: bounds, texts: points.map(({ outcome }) => boundText(outcome ?? {})), dots: true },
    { key: 'observed', label: observedName(points), colour: '--c-nom', y: observed, dots: true },
  ]
  return {
    ...chartOf(points, axis, height, sync),
    label: `Upper bound on P(violation) of ${points.length} runs`,
    lines,
    yRange: [0, highest > 0 ? 1.12 * highest : 1],
    yText: (y) => probability(y / 100),
  }
}

/** The name of the bounds with their confidence, if all share it. */
export function boundName(points: readonly At[]): string {
  const confidences = [...new Set(points.flatMap(({ outcome }) => outcome?.confidence ?? []))]
  return confidences.length === 1 ? `Upper bound, ${confidenceText(confidences[0])} confidence` : 'Upper bound'
}

/** The fraction of the sample that violates. */
export const fractionOf = (outcome: Outcome | null): number | null =>
  outcome?.samples && outcome.violations !== null ? outcome.violations / outcome.samples : null

/** The name of the observed fractions: a failed evaluation counts as a violation that was not observed. */
export const observedName = (points: readonly At[]): string =>
  points.some(({ outcome }) => outcome?.failed_samples) ? 'Violating or failed fraction' : 'Observed fraction'

/** "0 of 3 000", or "4 of 60, 4 failed", for a table. */
export function sampleOf(outcome: Outcome | null): string {
  if (!outcome?.samples || outcome.violations === null) return ''
  const failed = outcome.failed_samples ? `, ${fixed(outcome.failed_samples, 0)} failed` : ''
  return `${fixed(outcome.violations, 0)} of ${fixed(outcome.samples, 0)}${failed}`
}

/** For screen readers: every run in words. */
export const spoken = (points: readonly At[], name: (point: At) => string): string =>
  points
    .map((point) => {
      const { outcome } = point
      const margin = outcome?.margin === null || outcome?.margin === undefined ? '' : `, margin ${plain(outcome.margin, 4)} ${outcome.unit}`
      return `${name(point)}: ${outcome ? wordOf(outcome) : 'Purged'}${margin}${outcome?.unconfirmed ? `. ${outcome.unconfirmed}` : ''}`
    })
    .join('; ')
