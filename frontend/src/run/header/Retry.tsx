// The way on for a failed run: it goes on from its stored evaluations.
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { retryRun } from '../../api/calls'
import { putRun } from '../../api/events'
import { useBarredFromOwn } from '../../api/may'
import type { RunDetail } from '../../client'
import { count } from '../../format/numbers'
import { Button } from '../../ui/Button'
import { Refused } from '../../ui/Form'

export function Retry({ run }: { run: RunDetail }) {
  const cache = useQueryClient()
  const barred = useBarredFromOwn('engineer', run)
  const retry = useMutation({ mutationFn: () => retryRun(run.id), onSuccess: (found) => putRun(cache, found) })
  const kept = run.evaluations === 0 ? '' : `, keep ${count(run.evaluations)} ${run.evaluations === 1 ? 'evaluation' : 'evaluations'}`
  return (
    <>
      <Button disabled={retry.isPending} barred={barred} onClick={() => retry.mutate()}>
        Retry{kept}
      </Button>
      <Refused error={retry.error} />
    </>
  )
}
