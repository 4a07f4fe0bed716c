// Removes a part from a campaign with all references to it, and shifts the indices of later parts, in the document and,
// change by change, in its text.
import { type Campaign, type List, listAt, movedPath, without } from '../../api/campaign'
import { applied, type Change, changesOf } from './changes'
import type { At } from './tree'

/** The campaign without one part of a list, and the changes that lead to it: later parts keep their lines. */
export function takingOut(campaign: Campaign, list: List | 'objectives', index: number): [Campaign, Change[]] {
  const after = without(campaign, list, index)
  const [gone, moved]: [Change[], Change[]] = [[], []]
  for (const at of mapsOf(campaign))
    for (const path of Object.keys(at.values)) {
      const to = movedPath(path, list, index)
      if (to === null) gone.push({ kind: 'remove', at: [...at.at, path] })
      else if (to !== path) moved.push({ kind: 'rename', at: [...at.at, path], to })
    }
  const changes: Change[] = [{ kind: 'remove', at: [...listAt(list), index] }, ...gone, ...moved]
  return [after, [...changes, ...changesOf(changes.reduce(applied, campaign as never), after)]]
}

/** The mappings whose keys are paths of parameters. */
function mapsOf({ uncertain, stages, published = [] }: Campaign): { at: At; values: object }[] {
  return [
    { at: ['uncertain'], values: uncertain },
    ...stages.search.flatMap(({ starts = [] }, i) =>
      starts.map((start, j) => ({ at: ['stages', 'search', i, 'starts', j], values: start })),
    ),
    ...published.map(({ at = {} }, i) => ({ at: ['published', i, 'at'], values: at })),
  ]
}
