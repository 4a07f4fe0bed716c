// In what another run of the same campaign differs, in words.
import type { RelatedRun } from '../client'
import { namesOf } from './code'

export function differenceOf({ differs, code_changes: names, code_known: known, seed }: Pick<RelatedRun, 'differs' | 'code_changes' | 'code_known' | 'seed'>): string {
  const parts = differs.map((what) => (what === 'seed' ? `seed ${seed ?? 'unknown'}` : `code: ${namesOf(names)}`))
  if (!known) parts.push('code not known')
  return parts.join(', ') || 'nothing'
}
