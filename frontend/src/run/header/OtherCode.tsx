// The ways on for a run that waits for the code that began it: begin it again, or continue it as a new run.
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { useNavigate } from '@tanstack/react-router'
import { continueRun, restartRun } from '../../api/calls'
import { useBarredFromOwn } from '../../api/may'
import { putRun } from '../../api/events'
import type { RunDetail } from '../../client'
import { count } from '../../format/numbers'
import { Button } from '../../ui/Button'
import { Refused } from '../../ui/Form'
import { layout } from '../../ui/styles'

export function OtherCode({ run }: { run: RunDetail }) {
  const cache = useQueryClient()
  const navigate = useNavigate()
  const barred = useBarredFromOwn('engineer', run)
  const restart = useMutation({ mutationFn: () => restartRun(run.id), onSuccess: (found) => putRun(cache, found) })
  const carry = useMutation({
    mutationFn: () => continueRun(run.id),
    onSuccess: (found) => navigate({ to: '/runs/$id', params: { id: found.id } }),
  })
  const busy = restart.isPending || carry.isPending
  const refused = restart.error ?? carry.error
  return (
    <div style={{ marginBottom: 'var(--gap)' }}>
      <div className={layout.acts}>
        {run.not_continuable === null && (
          <Button disabled={busy} barred={barred} onClick={() => carry.mutate()}>
            Continue as a new run
          </Button>
        )}
        <Button danger disabled={busy} barred={barred} onClick={() => restart.mutate()}>
          Begin again, discard {count(run.evaluations)} {run.evaluations === 1 ? 'evaluation' : 'evaluations'}
        </Button>
      </div>
      {run.not_continuable !== null && <p className="small sec">It cannot be continued as a new run: {run.not_continuable}.</p>}
      <Refused error={refused} />
    </div>
  )
}
