// What becomes of a 3D view: it opens, it is lost, it is opened again, or it is given up. States, events and transitions
// as data, without time and without requests; `View` does what a state asks for and hands in what came of it.
// Start reading at `TRANSITIONS`; docs/architecture.md shows them as a diagram.

/** How long the service waits for a view whose frame is new to open [s]. */
export const OPENING = 30
/** So many frames are tried before the view is given up. */
export const FRAMES = 2
/** So many requests for news in a row may fail. */
export const MISSES = 2

/**
 * asking: the service is asked for the view, whose frame is there. open: the page listens for news of it.
 * resting: the service does not answer, and is asked again after a while. failed: given up, until the visitor tries again.
 * closed: the page has no need of it.
 */
export type Name = 'closed' | 'asking' | 'open' | 'resting' | 'failed'

export type Event =
  /** The page wants the view, and has made a frame for it. */
  | { kind: 'wanted' }
  /** The view is open, and was told what it is to show. */
  | { kind: 'opened' }
  /** The service has no such view (404): its socket is lost, or did not open in time. */
  | { kind: 'absent'; wait?: number }
  /** Something that it is to show is there no more (422). */
  | { kind: 'refused'; why: string }
  /** The service does not answer, or answers that it cannot now (5xx): it stops, starts, or is busy. */
  | { kind: 'silent'; why: string }
  /** The service will not: the session has ended (401), the run was purged (410). */
  | { kind: 'barred'; why: string }
  /** News of the view. */
  | { kind: 'heard' }
  /** A request for news was not answered; `wait` as in absent. */
  | { kind: 'missed'; wait?: number }
  | { kind: 'rested' }
  /** The visitor tries again. */
  | { kind: 'retried' }
  /** The page is left, or the view is out of sight. */
  | { kind: 'left' }

export type Kind = Event['kind']

export interface Machine {
  readonly name: Name
  /** Which of the frames made since the view was open or the service silent. */
  readonly frames: number
  /** How long the service may wait for the view to open [s]. */
  readonly wait: number
  /** What a view that opens is told beside what the page wants: all that it showed before, or no longer that. */
  readonly restores: 'nothing' | 'all' | 'part'
  /** Requests for news in a row that failed. */
  readonly misses: number
  /** The view or the service was lost since it was open last. */
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

/** By state, what each event makes of it; an event that is not listed changes nothing. */
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
    missed: (machine, { wait }) =>
      machine.misses + 1 < MISSES ? { ...machine, misses: machine.misses + 1 } : lost(machine, wait),
  },
  resting: { ...left, rested: (machine) => ({ ...machine, name: 'asking', frames: 0, wait: 0 }) },
  failed: {
    ...left,
    retried: (machine) => ({ ...machine, name: 'asking', frames: 1, wait: OPENING, lost: false, why: '' }),
  },
}

/** The machine after an event. */
export function next(machine: Machine, event: Event): Machine {
  const step = TRANSITIONS[machine.name][event.kind] as ((machine: Machine, event: Event) => Machine) | undefined
  return step ? step(machine, event) : machine
}

/** Whether the step from one to the other needs a new frame: the one that is there did not open. */
export const reframed = (before: Machine, after: Machine): boolean =>
  after.name === 'asking' && after.frames > 0 && (before.name === 'failed' || (before.name === 'asking' && after.frames > before.frames))

/** What the visitor sees of it. */
export function phaseOf({ name, lost }: Machine): 'opening' | 'open' | 'lost' | 'failed' {
  if (name === 'open' || name === 'failed') return name
  return lost ? 'lost' : 'opening'
}

/** A sentence for the visitor: what is wrong and what becomes of it, or that the view is back. */
export function saidOf({ name, why, lost, restores }: Machine): string {
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
