// Browser notifications when a run has ended, on request: for all own runs, or single ones. The choice is stored in this
// browser. A hidden tab has no event stream, so this polls the service.
import { useQuery } from '@tanstack/react-query'
import { useEffect, useState } from 'react'
import { getRun, listRuns } from '../api/calls'
import { isLive, LIVE, sessionQuery } from '../api/queries'
import type { RunSummary } from '../client'
import { decimalsFor, margin } from '../format/numbers'
import { at } from '../format/root'
import { store, stored, storeOf } from '../ui/store'
import { wordOf } from '../ui/VerdictBadge'

export interface Wanted {
  /** All runs that I submit. */
  mine: boolean
  /** Single runs. */
  runs: readonly string[]
}

const [KEY, UNABLE] = ['notify', 'notify unable']
const PERIOD = 5000
const NOTHING: Wanted = { mine: false, runs: [] }

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

/** Whether this browser failed to show one: Chrome on Android has the class, but withholds it from pages. */
const unable = storeOf(stored(UNABLE) !== null)

/** A notification, which is not shown without permission; null, from then on, where pages can have none. */
function made(title: string, options?: NotificationOptions): Notification | null {
  try {
    return new Notification(title, options)
  } catch {
    unable.set(true)
    store(UNABLE, 'yes')
    want(NOTHING)
    return null
  }
}

type Open = (run: string) => void

type Asked = 'granted' | 'denied' | 'insecure' | 'unavailable'

const WHY: Record<Asked, string> = {
  granted: '',
  denied: 'Blocked by the browser’s settings for this site.',
  insecure: 'Notifications need HTTPS, or a browser on the service’s machine.',
  unavailable: 'This browser shows no notifications of pages. Use one on a computer.',
}

/** Asks the user for permission, once. */
async function permitted(): Promise<Asked> {
  if (!isSecureContext) return 'insecure'
  if (!('Notification' in window) || unable.get()) return 'unavailable'
  if (Notification.permission === 'granted') return 'granted'
  if (!made('')) return 'unavailable'
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

/** Why notifications could not be turned on, if so; and what turns them on or off. */
export function useToggle(toggle: () => Promise<Asked>): [why: string, press: () => void] {
  const [answer, setAnswer] = useState<Asked>('granted')
  return [WHY[unable.useValue() ? 'unavailable' : answer], () => void toggle().then(setAnswer)]
}

/** Tells of followed runs that have ended; the live ones, also those that are not in a list with a limit. */
export async function looked(before: ReadonlySet<string>, listed: readonly RunSummary[], follows: (run: RunSummary) => boolean, open: Open): Promise<Set<string>> {
  const live = new Set(listed.filter(follows).map((run) => run.id))
  for (const id of [...before].filter((id) => !listed.some((run) => run.id === id))) {
    const run = await getRun(id)
    if (isLive(run)) live.add(id)
    else tell(run, open)
  }
  return live
}

/** Notifies of ended runs while this tab is open. */
export function useNotifier(open: Open): void {
  const { mine, runs } = useWanted()
  const user = useQuery(sessionQuery).data?.account
  const on = (mine || runs.length > 0) && 'Notification' in window && Notification.permission === 'granted'
  useEffect(() => {
    if (!on) return
    let before = new Set(wanted.get().runs)
    const follows = (run: RunSummary) => (mine && run.owner === user) || runs.includes(run.id)
    const look = async () => {
      const { items } = await listRuns({ state: [...LIVE] }, null, 200)
      before = await looked(before, items, follows, open)
    }
    // A failed request is repeated at the next interval.
    const timer = setInterval(() => void look().catch(() => undefined), PERIOD)
    void look().catch(() => undefined)
    return () => clearInterval(timer)
  }, [on, mine, runs, user, open])
}

export function tell(run: RunSummary, open: Open): void {
  // The tag merges notifications from several tabs.
  const message = made(`${run.id} ${wordOf(run).toLowerCase()}`, { body: bodyOf(run), tag: run.id, icon: at('/favicon.svg') })
  if (!message) return
  if (wanted.get().runs.includes(run.id)) want({ ...wanted.get(), runs: wanted.get().runs.filter((id) => id !== run.id) })
  message.onclick = () => {
    focus()
    open(run.id)
    message.close()
  }
}

export function bodyOf(run: Pick<RunSummary, 'name' | 'token' | 'margin' | 'unit' | 'error' | 'verdict'>): string {
  const name = run.token ? `${run.name} (token ${run.token})` : run.name
  const found = run.margin !== null && `margin ${margin(run.margin, decimalsFor([run.margin]))} ${run.unit}`
  if (run.verdict) return found ? `${name}: ${found}` : name
  const against = found && Number(run.margin) <= 0 && `${found}, which no verdict confirms`
  return [name, run.error, against].filter(Boolean).join(': ')
}
