// The card of the encounter: flights that fail after the horizon, parameters along which evaluations have no value.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it, vi } from 'vitest'
import { run } from '../../../tests/fixtures'
import type { Encounter } from '../../client'
import { asCampaign } from '../../api/campaign'

vi.mock('../../help/links', () => ({ HelpLink: () => null }))
// Files share their modules: one before this may have loaded the card with real links.
vi.resetModules()
const { EncounterCard } = await import('./EncounterCard')

const shown = (changes: object, measured_to = 'centre') => {
  const encounter = {
    closest: { time: 7.5, at: 'inside', obstacle: 0 }, moved: 9, unseen: null,
    spread: { evaluations: 300, lowest: 0.8, highest: 1 }, influence: {}, ...changes,
  } as unknown as Encounter
  const criterion = { name: 'd', component: 'd', title: 'D', quantity: 'd', unit: 'm', worse: 'low', measured_to }
  const of = { ...run(), criteria: [criterion] }
  const data = { run: of, campaign: asCampaign(of.campaign), findings: [], stages: [], parameters: [] } as never
  return renderToStaticMarkup(<EncounterCard data={data} encounter={encounter} />)
    .replaceAll(/<[^>]*>/g, '')
}

const beyond = { times: 2, flights: 302, closer: 1, cut_short: 301 }
const later = { name: 'F1', value: 0.5, time: 2, obstacle: 0, distance: 3, closing: 1, simulated: true }

it('states how many flights fail after the horizon, and when the lowest one does', () => {
  const html = shown({ beyond: { ...beyond, lowest: { ...later, until: 71.4 } } })
  expect(html).toContain('; 301 fail after the horizon, extrapolated from there')
  expect(html).toContain(', fails after 71.4 s')
  expect(shown({ beyond: { ...beyond, cut_short: 1, lowest: null } })).toContain('; 1 fails after')
  const none = shown({ beyond: { ...beyond, cut_short: 0, lowest: later } })
  expect(none).toContain('come closer')
  expect(none).not.toContain('fail')
})

it('states no lowest approach where a lower one may come, and whose motion is not known', () => {
  const unknown = { ...later, value: 0.2, simulated: false }
  expect(shown({ beyond: { ...beyond, lowest: later, unknown } })).toContain('the obstacle moves on: dmin 0.2 m')
  const html = shown({ beyond: { ...beyond, lowest: later, unknown: { ...unknown, vehicle: true } } })
  expect(html).toContain('the vehicle moves on: dmin 0.2 m')
  expect(html).not.toContain('0.5 m')
  expect(shown({ beyond: { ...beyond, lowest: { ...later, value: 0.1 }, unknown } })).toContain('dmin 0.1 m')
})

it('states of a criterion without distances that nothing is known beyond what is simulated', () => {
  const html = shown({ beyond: { ...beyond, lowest: null } }, '')
  expect(html).toContain('; 301 fail after the horizon; nothing is known beyond 2 times the horizon')
  expect(shown({ beyond: { ...beyond, lowest: null } })).not.toContain('nothing is known')
})

it('shows each change in its own digits, whatever another parameter changes', () => {
  const html = shown({ influence: { a: 999_995, b: 0.4 } })
  expect(html).toContain('b: 0.4 m')
})

it('names the parameters along which evaluations have no value', () => {
  const html = shown({ influence: { a: 0, b: 1 }, no_value: { a: ['failed', 'excluded'], c: ['excluded'] } })
  expect(html).toMatch(/a: 0\S* m \(evaluations along it fail or are excluded\)/)
  expect(html).toContain('c: not known (evaluations along it are excluded)')
  expect(html).toMatch(/b: 1\S* m; /)
})
