// The way on for a failed run: it goes on from its stored evaluations; if none has a value, they are made again.
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { retryRun } from '../../api/calls'
import { putRun } from '../../api/events'
import { useBarredFromOwn } from '../../api/may'
import type { RunDetail } from '../../client'
import { type Counted, valued } from '../../format/counts'
import { count } from '../../format/numbers'
import { Button } from '../../ui/Button'
import { Refused } from '../../ui/Form'

/** What the button says: the evaluations are kept if any of them has a value. */
export function retryWords(run: Counted): string {
  return valued(run) === 0 ? 'Retry' : `Retry, keep ${count(run.evaluations)} ${run.evaluations === 1 ? 'evaluation' : 'evaluations'}`
}

export function Retry({ run }: { run: RunDetail }) {
  const cache = useQueryClient()
  const barred = useBarredFromOwn('engineer', run)
  const retry = useMutation({ mutationFn: () => retryRun(run.id), onSuccess: (found) => putRun(cache, found) })
  return (
    <>
      <Button disabled={retry.isPending} barred={barred} onClick={() => retry.mutate()}>
        {retryWords(run)}
      </Button>
      <Refused error={retry.error} />
    </>
  )
}
