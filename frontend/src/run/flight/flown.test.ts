// Stored flights as curves over time, and thumbnails of findings.
import { expect, it } from 'vitest'
import * as fixtures from '../../../tests/fixtures'
import type { TraceColumn, TraceData, TraceHead } from '../../client'
import { aboveOf, acrossOf, curveOf, extentOf, overTime, shownColumns, spanOf, wordsOf } from './flown'
import { linesOn } from '../../charts/series'

const column = (name: string, unit: string, group: TraceColumn['group']): TraceColumn => ({ name, symbol: name, unit, group })
const COLUMNS = [
  column('t', 's', 'time'),
  column('x', 'm', 'pose'),
  column('u', 'm/s', 'state'),
  column('v', 'm/s', 'state'),
  column('p', 'rad/s', 'state'),
  column('fuel', 'kg', 'state'),
  column('elevator', 'rad', 'command'),
  column('aileron', 'rad', 'command'),
  column('u_demand', 'm/s', 'command'),
  column('psi_demand', 'rad', 'command'),
  column('d', 'm', 'separation'),
]
const flight = (separation: (number | null)[], meta: Partial<TraceHead> = {}): TraceData =>
  fixtures.flight({
    rows: separation.length,
    columns: COLUMNS,
    meta: fixtures.head(meta),
    data: { t: separation.map((_, i) => i), d: separation, u: separation.map((_, i) => 10 * i) },
  })
const closest = { time: 2, row: 2, value: 1, speed: 3, position: [0, 0, -30], obstacle: 0, obstacle_position: [40, 0, 0] }
const FLIGHT = flight([9, 2, 1, 1.5, 9, 9], { closest, frame: 'ned' })
const names = (columns: TraceColumn[]) => columns.map(({ name }) => name)

it('shows the encounter, or the whole flight', () => {
  expect(spanOf([FLIGHT], 0.5, 'encounter')).toEqual([1, 3])
  expect(spanOf([FLIGHT], 4.5, 'encounter')).toEqual([0, 5])
  expect(spanOf([FLIGHT], 0.5, 'all')).toEqual([0, 5])
  expect(spanOf([], 0.5, 'encounter')).toEqual([0, 1])
  // Too few rows are near to form an encounter.
  expect(spanOf([flight([9, 9, 9])], 1, 'encounter')).toEqual([0, 2])
})

it('has every speed and every command, speeds first, what is asked for last', () => {
  expect(names(overTime(FLIGHT))).toEqual(['u', 'v', 'p', 'elevator', 'aileron', 'u_demand', 'psi_demand'])
  expect(overTime(undefined)).toEqual([])
})

it('shows the columns asked for, of many the usual ones', () => {
  const all = overTime(FLIGHT)
  expect(names(shownColumns(all, 'aileron,u,nothing'))).toEqual(['u', 'aileron'])
  expect(names(shownColumns(all, undefined))).toEqual(['u', 'p', 'elevator', 'aileron'])
  expect(names(shownColumns(all, 'nothing'))).toEqual(['u', 'p', 'elevator', 'aileron'])
  expect(shownColumns(all.slice(0, 6), undefined)).toHaveLength(6)
})

it('reads values between rows, and none outside', () => {
  const curve = curveOf(FLIGHT, 'u')
  expect([1.5, 0, 5, 6].flatMap((time) => linesOn([time], curve))).toEqual([15, 0, 50, null])
  expect(linesOn([0.5], { x: [0, 1], y: [null, 1] })).toEqual([null])
  expect(extentOf([curve], [1, 3])).toEqual([10, 30])
  expect(extentOf([curve], [9, 10])).toBeNull()
})

it('knows how far above or below the obstacle the closest approach is', () => {
  expect(aboveOf(flight([1]))).toBeNull()
  expect(aboveOf(FLIGHT)).toBe('30\u202fm above')
  expect(aboveOf(flight([1], { closest, frame: 'enu' }))).toBe('30\u202fm below')
  expect(aboveOf(flight([1], { closest: { ...closest, value: 500 } }))).toBeNull()
})

it('describes what the symbol does not', () => {
  expect(wordsOf({ name: 'omega_demand', symbol: 'ω_d' })).toBe('demand')
  expect(wordsOf({ name: 'u_ref', symbol: 'u_ref' })).toBe('reference')
  expect(wordsOf({ name: 'elevator', symbol: 'δ_e' })).toBe('elevator')
  expect(wordsOf({ name: 'omega', symbol: 'ω' })).toBe('')
})

it('leaves few places empty', () => {
  const pairs = [[6, 5], [6, 2], [7, 5], [14, 5], [1, 4]] as const
  expect(pairs.map(([count, most]) => acrossOf(count, most))).toEqual([3, 2, 4, 5, 1])
})
