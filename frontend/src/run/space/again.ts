// Compares a stored evaluation with its simulation, which gives the same bits in the run's version on its machine kind.
import type { FlightAnswer } from '../../client'
import { namesOf } from '../../trends/code'
import type { Fate } from './space'

interface Stored {
  /** NaN without a value. */
  cost: number
  fate: Fate
}

/** A clause on the result of the simulation. */
export function againOf(answer: Pick<FlightAnswer, 'cost' | 'status' | 'reason' | 'code_changes'>, stored: Stored): string {
  const names = answer.code_changes
  return `${clauseOf(answer, stored)}${names.length > 0 ? ` (other code than the run: ${namesOf(names)})` : ''}`
}

function clauseOf({ cost, status, reason }: Pick<FlightAnswer, 'cost' | 'status' | 'reason'>, stored: Stored): string {
  const known = !Number.isNaN(stored.cost)
  if (known && cost !== null) return cost === stored.cost ? 'identical to the stored value' : `differs from the stored value by ${Math.abs(cost - stored.cost).toPrecision(3)}`
  const fate = status === 'timeout' ? 'failed' : status
  const why = [status, ...(reason ? [reason.replace(/\.$/, '')] : [])].join(': ')
  return !known && cost === null && fate === stored.fate ? `${why}, as stored` : `${why}, unlike the stored evaluation`
}
