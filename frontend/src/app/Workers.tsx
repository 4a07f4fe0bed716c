// In the header of every page: how many workers are alive; on request each with its host, run and stage.
import { IconAlertTriangle, IconCpu, IconLoader, IconMoon, IconPlayerPlay } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { clsx } from 'clsx'
import { useState } from 'react'
import { useStreamStatus } from '../api/events'
import { workersQuery } from '../api/queries'
import type { Space, WorkerOut, Workers as Known } from '../client'
import { count, fixed, thinned } from '../format/numbers'
import { age, moment } from '../format/time'
import { methodLook } from '../ui/methods'
import { Popup } from '../overlay/Popup'
import { RunLink } from '../ui/RunLink'
import { useNow } from '../ui/useNow'
import { usePolling } from '../ui/usePolling'
import { buttons, layout } from '../ui/styles'
import styles from './workers.module.css'

/** How often the workers are asked for on a page without an open stream [ms]. */
const PERIOD = 4000

export function Workers() {
  const { data, dataUpdatedAt, refetch } = useQuery(workersQuery)
  const streamed = useStreamStatus() === 'open'
  usePolling(refetch, PERIOD, !streamed)
  const [opened, setOpened] = useState(false)
  if (!data) return null
  const busy = data.items.filter((worker) => worker.state === 'busy').length
  const none = data.alive === 0
  const full = data.space.short !== ''
  const still = data.still.length > 0
  const shown = none ? 'No worker' : full ? 'No space' : workers(data.alive)
  return (
    <Popup
      kind="dialog"
      opened={opened}
      onChange={setOpened}
      width={340}
      dropdown={{ 'aria-label': 'Workers' }}
      button={{
        className: clsx(buttons.btn, styles.target, (none || full || still) && styles.none),
        // The name contains what is shown, also in narrow windows, where that is the number alone.
        'aria-label': none
          ? 'No worker is alive, 0 workers'
          : `${full ? 'No space for new runs, ' : ''}${still ? 'a run stands still, ' : ''}${workers(data.alive)} alive, ${count(busy)} busy`,
        title: 'Workers',
        'data-testid': 'workers',
        children: (
          <>
            {none || full || still ? <IconAlertTriangle className="i s" aria-hidden /> : <IconCpu className="i s" aria-hidden />}
            <span className={styles.long}>{shown}</span>
            <span className={styles.short}>{count(data.alive)}</span>
          </>
        ),
      }}
    >
      <Listed data={data} ahead={dataUpdatedAt / 1000 - data.now} onLeave={() => setOpened(false)} />
    </Popup>
  )
}

const workers = (number: number): string => (number === 1 ? '1 worker' : `${count(number)} workers`)

/** ahead: the clock of this browser minus that of the heartbeats [s]. */
function Listed({ data, ahead, onLeave }: { data: Known; ahead: number; onLeave: () => void }) {
  const now = useNow(1000) - ahead
  return (
    <div className={styles.panel}>
      <Spans data={data} now={now} />
      {data.items.length > 0 && (
        <ul className={styles.list}>
          {data.items.map((worker) => (
            <li key={worker.name}>
              <State worker={worker} />
              <div className={clsx(layout.wrapAny, styles.what)}>
                <span className="b">
                  <Doing worker={worker} now={now} onLeave={onLeave} />
                </span>
                <span className="small mut">
                  <span className="mono">{worker.name}</span>
                  {!worker.name.startsWith(worker.host) && ` on ${worker.host}`}, since{' '}
                  <time dateTime={new Date(worker.started * 1000).toISOString()}>{moment(worker.started)}</time>
                  {worker.simulators.length > 0 && `, with ${worker.simulators.join(', ')}`}
                </span>
              </div>
            </li>
          ))}
        </ul>
      )}
      {data.still.map(({ run, since }) => (
        <p key={run}>
          <RunLink run={run} onClick={onLeave} /> stands still: no new evaluation for {age(now - since)}.
        </p>
      ))}
      <Room space={data.space} />
    </div>
  )
}

/** The space where the service writes, and that no run begins if it is short. */
function Room({ space }: { space: Space }) {
  if (space.short)
    return (
      <p>
        <span className="b">No new run begins</span>: {thinned(space.short)}.
      </p>
    )
  if (space.free === null) return null
  return <p className="small mut">{`${gigabytes(space.free)} free for results; below ${gigabytes(space.limit)} no new run begins.`}</p>
}

const gigabytes = (bytes: number): string => `${fixed(bytes / 1e9, 1)} GB`

/** How many are alive; if none is, when one was last seen and what to do. */
function Spans({ data, now }: { data: Known; now: number }) {
  const waiting = data.queued === 0 ? '' : data.queued === 1 ? ' 1 run waits.' : ` ${count(data.queued)} runs wait.`
  if (data.alive > 0) return <p>{`${workers(data.alive)} alive.${waiting}`}</p>
  return (
    <>
      <p>
        <span className="b">No worker is alive</span>
        {data.last_seen === null ? '.' : `; last seen ${age(now - data.last_seen)} ago.`}
        {waiting} No run starts until there is one.
      </p>
      <p className="small sec">
        Start one on this machine, with the data folder of the service: <code>clearance worker --data FOLDER</code>
      </p>
    </>
  )
}

function Doing({ worker, now, onLeave }: { worker: WorkerOut; now: number; onLeave: () => void }) {
  const run = worker.run && <RunLink run={worker.run} onClick={onLeave} />
  if (worker.state === 'silent')
    return (
      <>
        No heartbeat for {age(now - worker.beat)}
        {run && <>, had {run}</>}
      </>
    )
  if (!run) return <>{idle(worker)}</>
  const what = worker.doing ? 'Compiling' : stage(worker.stage)
  return (
    <>
      {run}
      {what && `: ${what}`}
      {worker.draining && ', then ends'}
    </>
  )
}

function idle(worker: WorkerOut): string {
  if (worker.draining) return 'Ends, takes no run'
  return worker.short ? 'Begins no run: its disk is short' : 'Idle'
}

/** Search, direct: with the title of the method. */
function stage(text: string | null): string {
  const [kind = '', method] = (text ?? '').split(', ')
  return method ? `${kind}, ${methodLook(method).title}` : kind
}

function State({ worker }: { worker: WorkerOut }) {
  if (worker.state === 'silent') return <IconAlertTriangle className="i s bad-t" aria-label="silent" />
  if (worker.doing) return <IconLoader className="i s" aria-label="compiling" />
  if (worker.state === 'busy') return <IconPlayerPlay className="i s" aria-label="busy" />
  return <IconMoon className="i s mut" aria-label="idle" />
}
