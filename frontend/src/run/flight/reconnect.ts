// The state machine of a 3D view: opening, lost, reopening, failed. States, events and transitions are data, without
// timers and requests; `View` runs the action of each state and feeds back its result; docs/architecture.md shows them as
// a diagram.

/** How long the service waits for the view of a new frame to open [s]. */
export const OPENING = 30
/** Number of frames tried before the view fails. */
export const FRAMES = 2
/** Number of consecutive failed requests that are tolerated. */
export const MISSES = 2

/**
 * asking: the service is asked for the view, whose frame is there. open: the page listens for news of it.
 * resting: the service does not respond, and is retried. failed: given up, until the visitor tries again.
 * closed: the page has no need of it.
 */
export type Name = 'closed' | 'asking' | 'open' | 'resting' | 'failed'

export type Event =
  /** The page needs the view, and has created a frame for it. */
  | { kind: 'wanted' }
  /** The view is open, and the state has been sent to it. */
  | { kind: 'opened' }
  /** The service has no such view (404): its socket is lost, or did not open in time. */
  | { kind: 'absent'; wait?: number }
  /** Part of the state no longer exists (422). */
  | { kind: 'refused'; why: string }
  /** The service does not respond, or is unavailable (5xx): it stops, starts, or is busy. */
  | { kind: 'silent'; why: string }
  /** The service refuses permanently: the session has ended (401), the run was purged or the view has failed (410). */
  | { kind: 'barred'; why: string }
  /** The view has changed. */
  | { kind: 'heard' }
  /** A request for changes failed; `wait` as in absent. */
  | { kind: 'missed'; wait?: number }
  | { kind: 'rested' }
  /** The visitor retries. */
  | { kind: 'retried' }
  /** The page is left, or the view is not visible. */
  | { kind: 'left' }

export type Kind = Event['kind']

export interface Machine {
  readonly name: Name
  /** Number of the frame since the view was open or the service unavailable. */
  readonly frames: number
  /** How long the service may wait for the view to open [s]. */
  readonly wait: number
  /** Whether the last displayed state is also restored in an opening view. */
  readonly restores: 'nothing' | 'all' | 'part'
  /** Consecutive failed requests for changes. */
  readonly misses: number
  /** Whether the view or the service was lost since it was last open. */
  readonly lost: boolean
  readonly why: string
}

export const CLOSED: Machine = { name: 'closed', frames: 0, wait: 0, restores: 'nothing', misses: 0, lost: false, why: '' }

const NOT_OPENED =
  'The 3D view did not open. If the browser has no 3D graphics (WebGL), enable them; otherwise try again.'

const failed = (machine: Machine, why: string): Machine => ({ ...machine, name: 'failed', why })

const lost = (machine: Machine, wait = 0): Machine => ({
  ...machine,
  name: 'asking',
  frames: 0,
  wait,
  restores: 'all',
  misses: 0,
  lost: true,
  why: '',
})

type Step<K extends Kind> = (machine: Machine, event: Extract<Event, { kind: K }>) => Machine
type Steps = { readonly [K in Kind]?: Step<K> }

const left: Steps = { left: () => CLOSED }

/** Transitions by state and event; events that are not listed have no effect. */
export const TRANSITIONS: Readonly<Record<Name, Steps>> = {
  closed: { wanted: () => ({ ...CLOSED, name: 'asking', frames: 1, wait: OPENING }) },
  asking: {
    ...left,
    opened: (machine) => ({ ...machine, name: 'open', misses: 0, lost: false, why: '' }),
    absent: (machine) =>
      machine.frames < FRAMES
        ? { ...machine, frames: machine.frames + 1, wait: OPENING }
        : failed(machine, NOT_OPENED),
    refused: (machine, { why }) =>
      machine.restores === 'all' ? { ...machine, restores: 'part' } : failed(machine, why),
    silent: (machine, { why }) => ({ ...machine, name: 'resting', lost: true, why }),
    barred: (machine, { why }) => failed(machine, why),
  },
  open: {
    ...left,
    heard: (machine) => ({ ...machine, misses: 0 }),
    absent: (machine, { wait }) => lost(machine, wait),
    barred: (machine, { why }) => failed({ ...machine, restores: 'all' }, why),
    missed: (machine, { wait }) =>
      machine.misses + 1 < MISSES ? { ...machine, misses: machine.misses + 1 } : lost(machine, wait),
  },
  resting: { ...left, rested: (machine) => ({ ...machine, name: 'asking', frames: 0, wait: 0 }) },
  failed: {
    ...left,
    retried: (machine) => ({ ...machine, name: 'asking', frames: 1, wait: OPENING, lost: false, why: '' }),
  },
}

/** The state machine after an event. */
export function next(machine: Machine, event: Event): Machine {
  const step = TRANSITIONS[machine.name][event.kind] as ((machine: Machine, event: Event) => Machine) | undefined
  return step ? step(machine, event) : machine
}

/** Whether the transition needs a new frame, because the current one did not open. */
export const reframed = (before: Machine, after: Machine): boolean =>
  after.name === 'asking' && after.frames > 0 && (before.name === 'failed' || (before.name === 'asking' && after.frames > before.frames))

/** The status shown to the visitor. */
export function phaseOf({ name, lost }: Machine): 'opening' | 'open' | 'lost' | 'failed' {
  if (name === 'open' || name === 'failed') return name
  return lost ? 'lost' : 'opening'
}

/** A notice for the visitor: the problem and its handling, or that the view is restored. */
export function statementOf({ name, why, lost, restores }: Machine): string {
  if (name === 'failed') return why
  if (name === 'open')
    return {
      nothing: '',
      all: 'The 3D view was lost and has been restored.',
      part: 'The 3D view was lost and has been partly restored.',
    }[restores]
  if (why) return `${why} The 3D view will be restored as soon as possible.`
  return lost ? 'The 3D view was lost. It is being restored.' : ''
}
