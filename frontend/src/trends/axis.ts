// The horizontal axis of a trend: the time of submission, or the order.
import type { At, Axis } from '../charts/outcomes'
import type { TrendRun } from '../client'
import { rfc3339, zone } from '../format/time'

export type Along = 'time' | 'order'

type Run = Pick<TrendRun, 'created'>

/** Runs closer to each other than this fraction of the whole time cannot be distinguished in a chart. */
const CLOSE = 0.01

/** Whether the runs are far enough apart in time for most of them to be seen on an axis of time. */
export function apart(runs: readonly Run[]): boolean {
  const gaps = gapsOf(runs)
  const whole = gaps.reduce((sum, gap) => sum + gap, 0)
  return whole > 0 && gaps.filter((gap) => gap >= CLOSE * whole).length >= gaps.length / 2
}

const gapsOf = (runs: readonly Run[]): number[] => runs.slice(1).map((run, i) => run.created - (runs[i] as Run).created)

interface Drawn {
  points: At[]
  axis: Axis
}

/** The runs, the oldest first, on this axis; a rule where the code changed between two of them. */
export function axisOf(runs: readonly TrendRun[], along: Along): Drawn {
  const x = runs.map((run, i) => (along === 'time' ? run.created : i + 1))
  const at = new Map(x.map((value, i) => [value, runs[i] as TrendRun]))
  const rules = runs.flatMap((run, i) =>
    run.code_changed ? [{ x: ((x[i - 1] ?? x[i] ?? 0) + (x[i] ?? 0)) / 2, colour: '--link' }] : [],
  )
  return {
    points: runs.map((outcome, i) => ({ x: x[i] as number, run: outcome.id, outcome })),
    axis: {
      ...(along === 'time'
        ? { xTitle: `Time of submission, ${zone()}`, xTime: true }
        : { xTitle: 'Runs in the order of submission, the oldest first', xTicks: ticksOf(runs.length) }),
      rules,
      xText: (value: number) => {
        const run = at.get(value)
        return run ? `${run.id}, submitted ${rfc3339(run.created)}` : ''
      },
    },
  }
}

/** Whole numbers, at most twelve. */
function ticksOf(runs: number): number[] {
  const step = Math.max(1, Math.ceil(runs / 12))
  return Array.from({ length: Math.ceil(runs / step) }, (_, i) => 1 + i * step)
}
