// Browser notifications when a run has ended, on request: for all own runs, or single ones. The choice is stored in this
// browser. A hidden tab has no event stream, so this polls the service.
import { useQuery } from '@tanstack/react-query'
import { useEffect } from 'react'
import { getRun, listRuns } from '../api/calls'
import { sessionQuery } from '../api/queries'
import type { RunSummary } from '../client'
import { decimalsFor, signed } from '../format/numbers'
import { store, stored, storeOf } from '../ui/store'
import { wordOf } from '../ui/VerdictBadge'

export interface Wanted {
  /** All runs that I submit. */
  mine: boolean
  /** Single runs. */
  runs: readonly string[]
}

const KEY = 'notify'
const PERIOD = 5000
const NOTHING: Wanted = { mine: false, runs: [] }
const LIVE = ['queued', 'running', 'cancelling'] as const

/** Reads the stored choice; tolerates invalid content. */
export function readWanted(text: string | null): Wanted {
  try {
    const { mine, runs } = JSON.parse(text ?? '{}') as Record<string, unknown>
    const known = Array.isArray(runs) ? runs.filter((run): run is string => typeof run === 'string') : []
    return { mine: mine === true, runs: known }
  } catch {
    return NOTHING
  }
}

const wanted = storeOf(readWanted(stored(KEY)))

function want(next: Wanted): void {
  wanted.set(next)
  store(KEY, JSON.stringify(next))
}

addEventListener('storage', () => wanted.set(readWanted(stored(KEY))))

export const useWanted = wanted.useValue

export type Asked = 'granted' | 'denied' | 'unavailable'

/** Asks the user for permission, once; browsers support it only on localhost and over HTTPS. */
async function permitted(): Promise<Asked> {
  if (!('Notification' in window) || !isSecureContext) return 'unavailable'
  if (Notification.permission === 'granted') return 'granted'
  return (await Notification.requestPermission()) === 'granted' ? 'granted' : 'denied'
}

/** Turns notifications of all own runs on or off. */
export async function toggleMine(): Promise<Asked> {
  const answer = wanted.get().mine ? 'granted' : await permitted()
  if (answer === 'granted') want({ ...wanted.get(), mine: !wanted.get().mine })
  return answer
}

/** Turns notifications of one run on or off. */
export async function toggleRun(run: string): Promise<Asked> {
  const on = wanted.get().runs.includes(run)
  const answer = on ? 'granted' : await permitted()
  if (answer === 'granted') want({ ...wanted.get(), runs: on ? wanted.get().runs.filter((id) => id !== run) : [...wanted.get().runs, run] })
  return answer
}

/** Requested runs that were active and have ended. */
export function endedOf(before: ReadonlySet<string>, live: readonly RunSummary[]): string[] {
  const now = new Set(live.map((run) => run.id))
  return [...before].filter((id) => !now.has(id))
}

/** Notifies of ended runs while this tab is open. */
export function useNotifier(open: (run: string) => void): void {
  const { mine, runs } = useWanted()
  const user = useQuery(sessionQuery).data?.account
  const on = (mine || runs.length > 0) && 'Notification' in window && Notification.permission === 'granted'
  useEffect(() => {
    if (!on) return
    let before = new Set(wanted.get().runs)
    const look = async () => {
      const { items } = await listRuns({ state: [...LIVE] }, null, 200)
      const ended = endedOf(before, items)
      before = new Set(items.filter((run) => (mine && run.owner === user) || runs.includes(run.id)).map((run) => run.id))
      for (const id of ended) tell(await getRun(id), open)
    }
    // A failed request is repeated at the next interval.
    const timer = setInterval(() => void look().catch(() => undefined), PERIOD)
    void look().catch(() => undefined)
    return () => clearInterval(timer)
  }, [on, mine, runs, user, open])
}

function tell(run: RunSummary, open: (run: string) => void): void {
  if (wanted.get().runs.includes(run.id)) want({ ...wanted.get(), runs: wanted.get().runs.filter((id) => id !== run.id) })
  // The tag merges notifications from several tabs.
  const message = new Notification(`${run.id} ${wordOf(run).toLowerCase()}`, {
    body: bodyOf(run),
    tag: run.id,
    icon: '/favicon.svg',
  })
  message.onclick = () => {
    focus()
    open(run.id)
    message.close()
  }
}

export function bodyOf(run: Pick<RunSummary, 'name' | 'token' | 'margin' | 'unit' | 'error' | 'verdict'>): string {
  const margin = run.verdict && run.margin !== null
  const name = run.token ? `${run.name} (token ${run.token})` : run.name
  if (margin) return `${name}: margin ${signed(run.margin, decimalsFor([run.margin]))} ${run.unit}`
  return run.error ? `${name}: ${run.error}` : name
}
