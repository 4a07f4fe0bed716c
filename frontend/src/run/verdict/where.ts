// Where a search method found the worst case.
import type { StageProgress } from '../../client'
import { count } from '../../format/numbers'

/**
 * A clause after the name of the method; a lower value than its own best came from the refinement in validation, a higher one
 * is another case than its best.
 */
export function whereOf(stage: Pick<StageProgress, 'best' | 'best_index'> | undefined, worst: number | null): string {
  if (stage?.best_index == null) return ''
  if (worst !== null && stage.best !== null && worst < stage.best) return ', refined in validation'
  if (stage.best !== worst) return ''
  return `, evaluation ${count(stage.best_index + 1)}`
}
