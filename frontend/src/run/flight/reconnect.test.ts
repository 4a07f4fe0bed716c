// All transitions of the reconnect state machine, compared with the diagram in the architecture guide.
import { describe, expect, it } from 'vitest'
import guide from '../../../../docs/architecture.md?raw'
import { CLOSED, type Event, type Kind, type Machine, type Name, next, OPENING, phaseOf, reframed, statementOf, TRANSITIONS } from './reconnect'

const first: Machine = { ...CLOSED, name: 'asking', frames: 1, wait: OPENING }
const open: Machine = { ...first, name: 'open' }
const again: Machine = { ...CLOSED, name: 'asking', restores: 'all', lost: true }
const resting: Machine = { ...again, name: 'resting', why: 'Nothing answers.' }
const failed: Machine = { ...again, name: 'failed', why: 'You are signed out.' }

interface Case {
  from: Machine
  event: Event
  to: Name
  holds?: Partial<Machine>
  frame?: boolean
}

const CASES: Record<string, Case> = {
  'closed, wanted: the service is asked for it': { from: CLOSED, event: { kind: 'wanted' }, to: 'asking', holds: { frames: 1, wait: OPENING, lost: false } },
  'asking, opened: it is open': { from: first, event: { kind: 'opened' }, to: 'open', holds: { restores: 'nothing', lost: false } },
  'asking, opened again: it is back': { from: again, event: { kind: 'opened' }, to: 'open', holds: { restores: 'all', lost: false } },
  'asking, absent: another frame is tried': { from: first, event: { kind: 'absent' }, to: 'asking', holds: { frames: 2, wait: OPENING }, frame: true },
  'asking, absent once more: it is given up': { from: { ...first, frames: 2 }, event: { kind: 'absent' }, to: 'failed' },
  'asking, refused: it opens without what is gone': { from: again, event: { kind: 'refused', why: 'no F9' }, to: 'asking', holds: { restores: 'part', frames: 0 } },
  'asking, refused although nothing is restored: it is given up': { from: first, event: { kind: 'refused', why: 'no F9' }, to: 'failed', holds: { why: 'no F9' } },
  'asking, silent: it rests': { from: again, event: { kind: 'silent', why: 'Nothing answers.' }, to: 'resting', holds: { lost: true, why: 'Nothing answers.' } },
  'asking, barred: it is given up': { from: again, event: { kind: 'barred', why: 'You are signed out.' }, to: 'failed', holds: { why: 'You are signed out.' } },
  'asking, left: it is closed': { from: again, event: { kind: 'left' }, to: 'closed', holds: CLOSED },
  'open, heard: it stays open': { from: { ...open, misses: 1 }, event: { kind: 'heard' }, to: 'open', holds: { misses: 0 } },
  'open, absent: it is opened again as it was': { from: open, event: { kind: 'absent', wait: 3 }, to: 'asking', holds: { restores: 'all', lost: true, frames: 0, wait: 3 } },
  'open, barred: it is given up, and restored once it is retried': { from: open, event: { kind: 'barred', why: 'It ended.' }, to: 'failed', holds: { restores: 'all', why: 'It ended.' } },
  'open, missed: once is not enough': { from: open, event: { kind: 'missed' }, to: 'open', holds: { misses: 1 } },
  'open, missed twice: it is opened again as it was': { from: { ...open, misses: 1 }, event: { kind: 'missed' }, to: 'asking', holds: { restores: 'all', lost: true, misses: 0, wait: 0 } },
  'open, left: it is closed': { from: open, event: { kind: 'left' }, to: 'closed' },
  'resting, rested: the service is asked again': { from: resting, event: { kind: 'rested' }, to: 'asking', holds: { frames: 0, wait: 0, lost: true, restores: 'all' } },
  'resting, left: it is closed': { from: resting, event: { kind: 'left' }, to: 'closed' },
  'failed, retried: a new frame is tried': { from: failed, event: { kind: 'retried' }, to: 'asking', holds: { frames: 1, wait: OPENING, restores: 'all', why: '' }, frame: true },
  'failed, left: it is closed': { from: failed, event: { kind: 'left' }, to: 'closed' },
}

it.each(Object.entries(CASES))('%s', (_, { from, event, to, holds = {}, frame = false }) => {
  const after = next(from, event)
  expect(after.name).toBe(to)
  expect(after).toMatchObject(holds)
  expect(reframed(from, after)).toBe(frame)
})

const LISTED = Object.entries(TRANSITIONS).flatMap(([from, steps]) => Object.keys(steps).map((kind) => `${from} ${kind}`))

it('has a test for every transition', () => {
  const tested = new Set(Object.values(CASES).map(({ from, event }) => `${from.name} ${event.kind}`))
  expect([...tested].sort()).toEqual([...LISTED].sort())
})

it('does nothing at an event that a state does not know', () => {
  const events: Record<Kind, Event> = {
    ...{ wanted: { kind: 'wanted' }, opened: { kind: 'opened' }, absent: { kind: 'absent' }, refused: { kind: 'refused', why: '' } },
    ...{ silent: { kind: 'silent', why: '' }, barred: { kind: 'barred', why: '' }, heard: { kind: 'heard' }, missed: { kind: 'missed' } },
    ...{ rested: { kind: 'rested' }, retried: { kind: 'retried' }, left: { kind: 'left' } },
  }
  for (const machine of [CLOSED, first, open, resting, failed])
    for (const event of Object.values(events))
      if (!LISTED.includes(`${machine.name} ${event.kind}`)) expect(next(machine, event)).toBe(machine)
})

it('is drawn in the architecture guide, transition for transition', () => {
  const ends = new Map<string, Set<string>>()
  for (const { from, event, to } of Object.values(CASES)) {
    const key = `${from.name} ${event.kind}`
    ends.set(key, (ends.get(key) ?? new Set()).add(to))
  }
  const rows = [...guide.matchAll(/^\| `(\w+)` \| `(\w+)` \| ((?:`\w+`(?:, )?)+) \|/gm)]
  const drawn = new Map(rows.map(([, from, kind, to]) => [`${from} ${kind}`, new Set(to?.match(/\w+/g))]))
  expect(drawn).toEqual(ends)
})

describe('the message to the visitor', () => {
  it.each<[string, Machine, string, string]>([
    ['while it opens first', first, 'opening', ''],
    ['once it is open', open, 'open', ''],
    ['while it is opened again', again, 'lost', 'The 3D view was lost. It is being restored.'],
    ['while the service is silent', resting, 'lost', 'Nothing answers. The 3D view will be restored as soon as possible.'],
    ['once it is back', { ...open, restores: 'all' }, 'open', 'The 3D view was lost and has been restored.'],
    ['once a part of it is back', { ...open, restores: 'part' }, 'open', 'The 3D view was lost and has been partly restored.'],
    ['when it is given up', failed, 'failed', 'You are signed out.'],
  ])('%s', (_, machine, phase, statement) => {
    expect(phaseOf(machine)).toBe(phase)
    expect(statementOf(machine)).toBe(statement)
  })
})
