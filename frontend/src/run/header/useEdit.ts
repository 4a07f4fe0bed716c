// Saves annotations of a run (name, tags, notes, pin) and updates the run everywhere.
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { editRun } from '../../api/calls'
import { putRun } from '../../api/events'
import type { RunDetail, RunEdit } from '../../client'

/** `tag` is that of the version which the edit replaces, where it must be the current one. */
export function useEdit(run: RunDetail, onDone?: (after: RunDetail, sent: RunEdit) => void, tag?: string) {
  const cache = useQueryClient()
  return useMutation({
    mutationFn: (change: RunEdit) => editRun(run.id, change, tag),
    onSuccess: (after, sent) => {
      putRun(cache, after)
      cache.setQueryData<RunDetail>(['run', run.id], after)
      void cache.invalidateQueries({ queryKey: ['facets'] })
      void cache.invalidateQueries({ queryKey: ['history', run.id] })
      onDone?.(after, sent)
    },
    // Refused because another user has changed them: show the current state.
    onError: () => void cache.invalidateQueries({ queryKey: ['run', run.id] }),
  })
}
