// Notifications of ended runs.
import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import type { RunSummary } from '../client'
import type * as Notify from './notify'

let notify: typeof Notify

/** What this browser stores. */
let storage: Map<string, string>

/** The notifications of a browser, in place of those that Node has not. */
class Shown {
  static permission = 'granted'
  static made: Shown[] = []
  static readonly requestPermission = () => Promise.resolve('granted')

  constructor(
    readonly title: string,
    readonly options: NotificationOptions,
  ) {
    Shown.made.push(this)
  }
}

/** That of Chrome on Android. */
class Withheld {
  static permission = 'default'
  static readonly requestPermission = vi.fn()

  constructor() {
    throw new TypeError('Illegal constructor. Use ServiceWorkerRegistration.showNotification() instead.')
  }
}

function browser(of: unknown, secure = true): void {
  vi.stubGlobal('Notification', of)
  vi.stubGlobal('isSecureContext', secure)
}

beforeEach(async () => {
  storage = new Map()
  vi.stubGlobal('window', globalThis)
  vi.stubGlobal('localStorage', { getItem: (key: string) => storage.get(key) ?? null, setItem: storage.set.bind(storage) })
  vi.stubGlobal('document', { documentElement: { dataset: { root: '/clearance' } } })
  // The module listens to changes of other tabs.
  vi.stubGlobal('addEventListener', () => undefined)
  vi.resetModules() // the path is read once, perhaps by a module that another file has loaded
  notify = await import('./notify')
  Shown.made = []
})
afterEach(() => {
  vi.unstubAllGlobals()
  vi.resetModules()
})

it('reads whatever is stored', () => {
  expect(notify.readWanted(null)).toEqual({ mine: false, runs: [] })
  expect(notify.readWanted('no json')).toEqual({ mine: false, runs: [] })
  expect(notify.readWanted('{"mine": true, "runs": ["R-0001", 7]}')).toEqual({ mine: true, runs: ['R-0001'] })
  expect(notify.readWanted('{"mine": "yes", "runs": "R-0001"}')).toEqual({ mine: false, runs: [] })
})

it('tells of those that have ended, not of those that a list with a limit leaves out', async () => {
  browser(Shown)
  const states: Record<string, string> = { 'R-0001': 'done', 'R-0002': 'running', 'R-0003': 'queued' }
  const run = (id: string) => ({ ...ENDED, id, state: states[id] }) as RunSummary
  vi.doMock('../api/calls', async (original) => ({ ...(await original<object>()), getRun: (id: string) => Promise.resolve(run(id)) }))
  vi.resetModules()
  notify = await import('./notify')
  const live = await notify.looked(new Set(['R-0001', 'R-0002']), [run('R-0003')], () => true, () => undefined)
  expect([...live].sort()).toEqual(['R-0002', 'R-0003'])
  expect(Shown.made.map(({ options }) => options?.tag)).toEqual(['R-0001'])
  vi.doUnmock('../api/calls')
})

it('states the outcome', () => {
  const run = { name: 'Release', token: null, margin: -2.3, unit: 'm', error: null, verdict: 'violated' as const }
  expect(notify.bodyOf(run)).toBe('Release: margin \u22122.300 m')
  expect(notify.bodyOf({ ...run, verdict: null, error: 'diverged', margin: 1 })).toBe('Release: diverged')
  expect(notify.bodyOf({ ...run, verdict: null, error: 'diverged' })).toBe('Release: diverged: margin \u22122.300 m, which no verdict confirms')
  expect(notify.bodyOf({ ...run, verdict: null, margin: null })).toBe('Release')
  expect(notify.bodyOf({ ...run, token: 'nightly' })).toBe('Release (token nightly): margin \u22122.300 m')
})

const ENDED = { id: 'R-0001', name: 'Release', token: null, margin: null, unit: 'm', error: null, verdict: null, state: 'cancelled' } as unknown as RunSummary

it('shows one with the picture of a service below a path, once', async () => {
  browser(Shown)
  expect(await notify.toggleRun('R-0001')).toBe('granted')
  expect(storage.get('notify')).toBe('{"mine":false,"runs":["R-0001"]}')
  notify.tell(ENDED, () => undefined)
  expect(Shown.made.map(({ options }) => options)).toEqual([{ body: 'Release', tag: 'R-0001', icon: '/clearance/favicon.svg' }])
  expect(storage.get('notify')).toBe('{"mine":false,"runs":[]}')
})

it('is not turned on where pages can show none, and permission is not requested', async () => {
  browser(Withheld)
  expect(await notify.toggleRun('R-0001')).toBe('unavailable')
  expect(Withheld.requestPermission).not.toHaveBeenCalled()
  expect(await notify.toggleMine()).toBe('unavailable')
  expect(notify.readWanted(storage.get('notify') ?? null)).toEqual({ mine: false, runs: [] })
})

it('is turned off by one that could not be shown, and stays so', async () => {
  browser(Shown)
  await notify.toggleMine()
  browser(Withheld)
  Withheld.permission = 'granted'
  notify.tell(ENDED, () => undefined)
  expect(storage.get('notify')).toBe('{"mine":false,"runs":[]}')
  vi.resetModules()
  notify = await import('./notify')
  expect(await notify.toggleMine()).toBe('unavailable')
})

it('tells plain HTTP from what the browser blocks', async () => {
  browser(class extends Shown { static override permission = 'denied' }, false)
  expect(await notify.toggleMine()).toBe('insecure')
  browser(class extends Shown { static override permission = 'denied'; static override requestPermission = () => Promise.resolve('denied') })
  expect(await notify.toggleMine()).toBe('denied')
})
