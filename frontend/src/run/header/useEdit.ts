// Saves annotations of a run (name, tags, notes, pin) and updates the run everywhere.
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { editRun } from '../../api/calls'
import { putRun } from '../../api/events'
import type { RunDetail, RunEdit } from '../../client'

export function useEdit(run: RunDetail, onDone?: () => void) {
  const cache = useQueryClient()
  return useMutation({
    mutationFn: (change: RunEdit) => editRun(run.id, change),
    onSuccess: (after) => {
      putRun(cache, after)
      cache.setQueryData<RunDetail>(['run', run.id], after)
      void cache.invalidateQueries({ queryKey: ['facets'] })
      void cache.invalidateQueries({ queryKey: ['history', run.id] })
      onDone?.()
    },
    // Refused because another user has changed them: show the current state.
    onError: () => void cache.invalidateQueries({ queryKey: ['run', run.id] }),
  })
}
