// The stored flight of a card in the picture's axes.
import { expect, it } from 'vitest'
import type { DrawnFlight } from '../../client'
import { nominalOf } from './nominal'
import { axesOf } from './plan'

const FLIGHT: DrawnFlight = {
  digest: '', code: '', status: 'ok', reason: '', value: 3, frame: 'ned',
  x: [0, 10, 20], y: [0, 1, 2],
  tracks: [{ obstacle: 1, x: [20, 10, 0], y: [5, 4, 3] }],
  closest: { time: 1, x: 10.4, y: 1, obstacle: 1, obstacle_x: 9.6, obstacle_y: 4 },
}

it('is north up, with moving obstacles where they are at the closest approach', () => {
  const { path, tracks, closest, moment } = nominalOf(FLIGHT, axesOf(true))
  expect(path.map(({ x, y }) => [x, y])).toEqual([[0, 0], [1, 10], [2, 20]])
  expect(tracks.get(1)?.[0]).toMatchObject({ x: 5, y: 20 })
  expect(closest).toMatchObject({ at: { x: 1, y: 10.4 }, other: { x: 4, y: 9.6 }, obstacle: 1 })
  expect(moment.get(1)).toMatchObject({ x: 4, y: 10 })
})

it('has obstacles at the start where nothing is closest, and survives a flight without rows', () => {
  expect(nominalOf({ ...FLIGHT, closest: null }, axesOf(false)).moment.get(1)).toMatchObject({ x: 20, y: 5 })
  const none = nominalOf({ ...FLIGHT, x: [], y: [], tracks: [{ obstacle: 1, x: [], y: [] }] }, axesOf(false))
  expect([none.path.length, none.moment.size]).toEqual([0, 0])
})
