// The result of a stage by its kind: the API's results are a union whose members `stage` distinguishes.
import type { StageDetail } from '../client'

type Result = NonNullable<StageDetail['result']>
type Kind = Result['stage']
type ResultOf<K extends Kind> = Extract<Result, { stage: K }>

const isOf = <K extends Kind>(result: Result, kind: K): result is ResultOf<K> => result.stage === kind

/** The result of a stage of that kind; null if there is none yet or the stage is of another kind. */
export function resultOf<K extends Kind>(stage: Pick<StageDetail, 'result'> | undefined, kind: K): ResultOf<K> | null {
  const result = stage?.result ?? null
  return result !== null && isOf(result, kind) ? result : null
}
