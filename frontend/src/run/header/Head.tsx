// The header of a run's page: identity, state, actions.
import { IconBell, IconBellFilled, IconPlayerStop, IconRefresh } from '@tabler/icons-react'
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import { clsx } from 'clsx'
import { useState } from 'react'
import { asCampaign, hasScenario } from '../../api/campaign'
import { cancelRun } from '../../api/calls'
import { putRun, useStreamStatus } from '../../api/events'
import { useBarredFromOwn } from '../../api/may'
import { isLive } from '../../api/queries'
import type { RunDetail } from '../../client'
import { ExportMenu } from '../../exports/ExportMenu'
import { withoutValue } from '../../format/counts'
import { count } from '../../format/numbers'
import { launchedBy } from '../../format/people'
import { dayAndClock, moment } from '../../format/time'
import { toggleRun, useToggle, useWanted } from '../../page/notify'
import { Button, ButtonLink } from '../../ui/Button'
import { Form } from '../../ui/Form'
import { Tags } from '../../ui/Card'
import { RunLink } from '../../ui/RunLink'
import { RunBadge } from '../../ui/VerdictBadge'
import { Modal } from '../../overlay/Modal'
import { EditRun } from './EditRun'
import { Remove } from './Removed'
import { badges, layout } from '../../ui/styles'
import runStyles from '../run.module.css'

export function Head({ run, stale }: { run: RunDetail; stale: boolean }) {
  // The button stays when the run ends: another in its place could be pressed by mistake.
  const [ran, setRan] = useState('')
  if (isLive(run) && ran !== run.id) setRan(run.id)
  return (
    <div className={layout.ph}>
      <div className={layout.grow}>
        <nav className={clsx(layout.row, layout.wrapAny, 'mut small', runStyles.crumb)} aria-label="Breadcrumb">
          <Link to="/runs" className="sec">Runs</Link>/<span>{run.campaign_name}</span>/<span className="mono">{run.id}</span>
        </nav>
        <div className={clsx(layout.row, runStyles.titles)}>
          <h1>{run.name}</h1>
          <span data-testid="outcome" aria-live="polite">
            <RunBadge run={run} />
          </span>
          <Tags tags={run.tags} />
          <Labels labels={run.labels} />
          <Requirements run={run} />
          {run.removed === null && <EditRun run={run} />}
          <span className="small mut nw" title={moment(run.created)}>
            {dayAndClock(run.created)}, {launchedBy(run)}
          </span>
          {run.evaluations > 0 && (
            <span className="small mut nw" data-testid="counts">
              {count(run.evaluations)} evaluations, {withoutValue(run)}
            </span>
          )}
          {run.continues && (
            <span className="small nw">
              Extends <RunLink run={run.continues} className="mono" />
            </span>
          )}
          {run.baseline?.run && (
            <span className="small nw">
              Baseline <RunLink run={run.baseline.run} className="mono" />
              {run.summary?.regression?.ok === false && (
                <>
                  :{' '}
                  <a href="#since" className="bad-t b">
                    the policy fails
                  </a>
                </>
              )}
            </span>
          )}
        </div>
      </div>
      <div className={layout.acts}>
        {!isLive(run) && run.removed === null && <Remove run={run} />}
        {isLive(run) && <Freshness stale={stale} />}
        {isLive(run) && <Bell run={run.id} />}
        {isLive(run) && hasScenario(asCampaign(run.campaign)) && (
          <ButtonLink to="/runs/$id/flight" params={{ id: run.id }} title="The flights found so far, and the searches">3D view</ButtonLink>
        )}
        <ExportMenu run={run} />
        <ButtonLink icon={IconRefresh} to="/launch" search={{ from: run.id }}>Run again</ButtonLink>
        {ran === run.id && <Cancel run={run} />}
      </div>
    </div>
  )
}

/** What the launch knew of the run; each leads to the runs with the same. */
function Labels({ labels }: { labels: RunDetail['labels'] }) {
  const pairs = Object.entries(labels)
  if (pairs.length === 0) return null
  return (
    <span data-testid="labels" className={runStyles.labels}>
      {pairs.map(([key, value]) => (
        <Link key={key} to="/runs" search={{ label: [`${key}=${value}`] }} className={badges.tag} title={`Show runs with the label ${key}=${value}`}>
          <span className="mut">{key}</span>&nbsp;{value}
        </Link>
      ))}
    </span>
  )
}

/** What its criterion is evidence for; each leads to its row of the matrix. */
function Requirements({ run }: { run: RunDetail }) {
  const requirements = asCampaign(run.campaign).criterion.requirements ?? []
  const stated = requirements.flatMap((one) => (typeof one === 'object' && one?.id ? [{ id: one.id, text: one.text }] : []))
  if (stated.length === 0) return null
  return (
    <span data-testid="requirements" className={runStyles.labels}>
      {stated.map(({ id, text }) => (
        <Link key={id} to="/requirements" search={{ q: id }} className={badges.tag} title={text ?? `Show the requirement ${id}`}>
          <span className="mut">requirement</span>&nbsp;{id}
        </Link>
      ))}
    </span>
  )
}

function Freshness({ stale }: { stale: boolean }) {
  const stream = useStreamStatus()
  const words = stale ? 'The service does not respond, retrying' : stream === 'open' ? 'Live' : 'Refreshing every 2 s'
  return (
    <span className={stale ? 'small bad-t nw' : 'small mut nw'} role="status">
      {words}
    </span>
  )
}

function Cancel({ run }: { run: RunDetail }) {
  const [asking, setAsking] = useState(false)
  const cache = useQueryClient()
  const cancel = useMutation({
    mutationFn: () => cancelRun(run.id),
    onSuccess: (summary) => {
      putRun(cache, summary)
      setAsking(false)
    },
  })
  const cancelling = run.state === 'cancelling'
  const over = !isLive(run)
  const barred = useBarredFromOwn('engineer', run)
  return (
    <>
      <Button
        danger
        icon={IconPlayerStop}
        disabled={cancelling || over || barred !== undefined}
        title={over ? 'This run has ended.' : barred}
        onClick={() => setAsking(true)}
      >
        {cancelling ? 'Cancelling …' : 'Cancel run'}
      </Button>
      <Modal opened={asking && !cancelling && !over} onClose={() => setAsking(false)} title={`Cancel ${run.id}?`}>
        <Form sent={cancel} onSend={() => cancel.mutate()} send="Cancel run" leave="Keep running" onLeave={() => setAsking(false)} danger>
          <p className="sec">
            The {count(run.evaluations)} completed evaluations are stored. A cancelled run has no verdict and cannot be resumed; it
            can be run again.
          </p>
        </Form>
      </Modal>
    </>
  )
}

/** Toggles the browser notification at the end of this run. */
function Bell({ run }: { run: string }) {
  const on = useWanted().runs.includes(run)
  const [why, press] = useToggle(() => toggleRun(run))
  return (
    <>
      {why && <span className="small bad-t">{why}</span>}
      <Button aria-pressed={on} onClick={press} title="Browser notification when this run ends">
        {on ? <IconBellFilled className="i s" aria-hidden /> : <IconBell className="i s" aria-hidden />}
        {on ? 'Will notify' : 'Notify me'}
      </Button>
    </>
  )
}
