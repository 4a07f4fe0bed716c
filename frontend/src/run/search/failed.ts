// Evaluations without a value: counts by kind, and one of them as text for a campaign.
import type { EvaluationFailure, Evaluations, StageProgress } from '../../client'

export type Fate = EvaluationFailure['status']

interface Meaning {
  /** Text in a table row. */
  word: string
  name: string
  text: string
}

export const MEANING: Record<Fate, Meaning> = {
  failed: {
    word: 'Failed',
    name: 'failed',
    text: 'the evaluation ended early, such as outside the model’s envelope or with an error; its outcome is unknown, which rules out “cleared”',
  },
  timeout: {
    word: 'Timed out',
    name: 'timed out',
    text: 'the evaluation exceeded its time limit; counted as failed',
  },
  excluded: {
    word: 'Excluded',
    name: 'excluded',
    text: 'a precondition does not hold there; such an evaluation is no evidence either way',
  },
}

/** Counts by kind, without zeros. */
export function countsOf(
  stages: readonly Pick<StageProgress, 'failed' | 'excluded'>[],
  evaluations: Pick<Evaluations, 'stages'> | undefined,
): { status: Fate; count: number }[] {
  const timeouts = (evaluations?.stages ?? []).reduce((sum, series) => sum + series.timeouts, 0)
  const failed = stages.reduce((sum, stage) => sum + stage.failed, 0)
  const excluded = stages.reduce((sum, stage) => sum + stage.excluded, 0)
  const all = [
    { status: 'failed' as const, count: Math.max(0, failed - timeouts) },
    { status: 'timeout' as const, count: timeouts },
    { status: 'excluded' as const, count: excluded },
  ]
  return all.filter(({ count }) => count > 0)
}

/** Parameters as a start of a search in a campaign file, at full precision for a bit-identical evaluation. */
export function startsYaml(parameters: Readonly<Record<string, number>>): string {
  const pairs = Object.entries(parameters).map(([path, value]) => `${path}: ${numberYaml(value)}`)
  return `starts:\n  - {${pairs.join(', ')}}\n`
}

/** YAML 1.1 reads 1e-07 as text: a number needs a dot before its exponent, and a sign after it. */
function numberYaml(value: number): string {
  const text = String(value)
  const [mantissa = '', exponent] = text.split('e')
  if (exponent === undefined) return text
  return `${mantissa.includes('.') ? mantissa : `${mantissa}.0`}e${/^[+-]/.test(exponent) ? exponent : `+${exponent}`}`
}
