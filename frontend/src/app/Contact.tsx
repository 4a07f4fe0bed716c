// Below the header of every page: the service does not answer or can do nothing, or live updates are interrupted; until that is over.
import { clsx } from 'clsx'
import { IconPlugConnectedX } from '@tabler/icons-react'
import { useQueryClient } from '@tanstack/react-query'
import { useEffect, useRef, useState } from 'react'
import { useStreamStatus } from '../api/events'
import { PATIENCE, pulse, useContact } from '../api/pulse'
import { age } from '../format/time'
import { useNow } from '../ui/useNow'
import { cards } from '../ui/styles'
import styles from './app.module.css'

/** What is read again once the service answers: what may have changed, not what is being edited. */
const CHANGING = ['run', 'runs', 'workers', 'stages', 'findings', 'evaluations', 'facets']

const TROUBLE = {
  silent: 'The service does not answer',
  unreachable: 'The service cannot be reached; start it on its machine with clearance serve',
  unusable: 'The service can do nothing',
}

export function Contact() {
  const contact = useContact()
  const interrupted = useInterrupted()
  const cache = useQueryClient()
  const well = contact.state === 'well'
  const before = useRef(well)
  useEffect(() => {
    const ask = () => document.hidden || pulse.tick()
    const timer = setInterval(ask, 1000)
    document.addEventListener('visibilitychange', ask)
    return () => {
      clearInterval(timer)
      document.removeEventListener('visibilitychange', ask)
    }
  }, [])
  useEffect(() => {
    if (well && !before.current)
      void cache.invalidateQueries({
        predicate: ({ queryKey, state }) => CHANGING.includes(String(queryKey[0])) || state.status === 'error',
      })
    before.current = well
  }, [cache, well])
  const now = useNow(1000)
  // The region exists before its content, so that screen readers announce what appears in it.
  return (
    <div className={styles.contact} role="status" aria-label="Connection">
      {contact.state !== 'well' ? (
        <p className={clsx(cards.note, cards.bad)}>
          <IconPlugConnectedX className="i" aria-hidden />
          <span>
            {TROUBLE[contact.state]}
            <span aria-hidden> (for {age(now - contact.since / 1000)})</span>
            {contact.state === 'unusable' && `: ${contact.why}`}. What this page shows may be
            out of date. It continues as soon as the service answers.
          </span>
        </p>
      ) : (
        interrupted && (
          <p className={clsx(cards.note, cards.warn)}>
            <IconPlugConnectedX className="i" aria-hidden />
            <span>Live updates are interrupted and are being restored. Until then this page asks every few seconds.</span>
          </p>
        )
      )}
    </div>
  )
}

/** Whether the event stream of this page has been trying to connect for longer than a moment. */
function useInterrupted(): boolean {
  const connecting = useStreamStatus() === 'connecting'
  const [late, setLate] = useState(false)
  useEffect(() => {
    if (!connecting) return
    const timer = setTimeout(() => setLate(true), PATIENCE)
    return () => {
      clearTimeout(timer)
      setLate(false)
    }
  }, [connecting])
  return late
}
