// Merging of changes, the addresses of views, and what a browser lacks.
import { afterEach, expect, it, vi } from 'vitest'
import { anyOf, View } from './view'
import { addressOf, again, merged } from '../data/viewChange'

afterEach(() => {
  vi.unstubAllGlobals()
  vi.restoreAllMocks()
})

it('puts changes together, the newest of each kind', () => {
  expect(merged({ time: 1, camera: 'top' }, { time: 2 })).toEqual({ time: 2, camera: 'top' })
  expect(merged({ time: 1 }, { step: 0.5 })).toEqual({ time: 1, step: 0.5 })
  expect(merged({ step: -0.1 }, { step: -0.1 })).toEqual({ step: -0.2 })
  expect(merged({ step: 1 }, { time: 3 })).toEqual({ time: 3 })
  expect(merged({ time: 3, step: 1 }, { closest: true })).toEqual({ closest: true })
  expect(merged({ closest: true }, { time: 3 })).toEqual({ time: 3 })
  expect(merged({ closest: true }, { camera: 'chase' })).toEqual({ closest: true, camera: 'chase' })
  expect(merged({ closest: true }, { step: 0.1 })).toEqual({ step: 0.1 })
  expect(merged({ time: 0, step: 0.1 }, {})).toEqual({ time: 0, step: 0.1 })
  expect(merged({ time: 1 }, { time: 2, passing: true })).toEqual({ time: 2, passing: true })
  expect(merged({ time: 1, passing: true }, { time: 2 })).toEqual({ time: 2 })
  const layers = [{ layers: { field: true } }, { layers: { sampled: true } }] as const
  expect(merged(...layers)).toEqual({ layers: { field: true, sampled: true } })
  expect(merged({ time: 1, passing: true }, { camera: 'top' })).toEqual({ time: 1, passing: true, camera: 'top' })
})

it('restores all that was shown in a reopened view', () => {
  const layers = {
    ...{ nominal: true, finding: true, what_if: false, velocity: false, relative: true, trail: 'so_far' as const },
    ...{ sampled: true, field: false, space: false, axes: ['a', 'b', 'value'] as [string, string, string] },
  }
  const eye = { position: [1, 2, 3] as [number, number, number], target: [0, 0, 0] as [number, number, number] }
  const last = { opened: 1, revision: 7, flight: 'F2', time: 3.5, horizon: 20, camera: null, eye, playing: true, speed: 2, panel: true, what_if: null, what_if_seed: null, what_if_source: null }
  const message = again({ ...last, theme: 'dark', layers })
  expect(message).toEqual({ flight: 'F2', theme: 'dark', time: 3.5, playing: true, speed: 2, panel: true, layers, eye })
  const noisy = again({ ...last, theme: 'dark', layers, what_if: { 'vehicle.m': 5 }, what_if_seed: 7 })
  expect(noisy).toMatchObject({ what_if: { 'vehicle.m': 5 }, what_if_seed: 7 })
  expect(again({ ...last, theme: 'dark', layers, what_if: { 'simulator.x': 5 } }, false)).toEqual(message)
  expect(merged(message, { camera: 'top', step: 1 })).toMatchObject({ time: 3.5, step: 1, camera: 'top' })
  expect(merged(message, { camera: 'top' })).not.toHaveProperty('eye')
  expect(merged(message, { closest: true })).not.toHaveProperty('time')
})

it('keeps one page for all views that a page opens', () => {
  const wanted = { flight: 'F2', theme: 'dark' } as const
  expect(addressOf('R-0001', wanted, { time: 2.5, camera: 'chase' }, 'k')).toBe(
    '/view/R-0001/#F2/t/2.5/cam/chase/dark/key/k/',
  )
  expect(addressOf('R-0001', wanted, {}, 'k')).toBe('/view/R-0001/#F2/dark/key/k/')
})

it('has a key of its own', () => expect(new View('R-0001').key).not.toBe(new View('R-0001').key))

it('joins signals without AbortSignal.any, which browsers of 2023 lack', () => {
  const [first, second] = [new AbortController(), new AbortController()]
  const joined = anyOf(first.signal, second.signal)
  expect(joined.aborted).toBe(false)
  second.abort('left')
  first.abort('late')
  expect([joined.aborted, joined.reason]).toEqual([true, 'left'])
  expect(anyOf(new AbortController().signal, first.signal)).toMatchObject({ aborted: true, reason: 'late' })
})

it('fails with a sentence where the browser lacks something else', async () => {
  vi.stubGlobal('document', new EventTarget())
  vi.stubGlobal('window', new EventTarget())
  vi.spyOn(AbortSignal, 'timeout').mockImplementation(() => {
    throw new TypeError('AbortSignal.timeout is not a function')
  })
  const view = new View('R-0001')
  view.want({ flight: 'F2', theme: 'dark' })
  const close = view.open({})
  await vi.waitFor(() => expect(view.known.phase).toBe('failed'))
  expect(view.known.statement).toBe(
    'This browser cannot show the 3D view (AbortSignal.timeout is not a function). Try again, or use a newer browser.',
  )
  close()
})
