// Plan view of flights: world axes, rows of the encounter, equal scales.
import { describe, expect, it } from 'vitest'
import * as fixtures from '../../../tests/fixtures'
import type { TraceData, TraceHead } from '../../client'
import { encounterOf, placeOf, scaleOf, trackOf } from './places'

const trace = (frame: TraceHead['frame'], separation: (number | null)[]): TraceData =>
  fixtures.flight({
    meta: fixtures.head({ frame }),
    data: { x: separation.map((_, i) => i), y: separation.map(() => 7), separation },
  })

describe('places', () => {
  it('have north up, whichever way the axes run', () => {
    expect(placeOf([1, 2, 3], 'enu')).toEqual({ east: 1, north: 2 })
    expect(placeOf([1, 2, 3], 'ned')).toEqual({ east: 2, north: 1 })
    expect(trackOf(trace('ned', [5, 5]))).toEqual([
      { east: 7, north: 0 },
      { east: 7, north: 1 },
    ])
  })
  it('show the encounter: within four times the larger of criterion and lowest', () => {
    const values = [...Array.from({ length: 40 }, (_, i) => Math.abs(i - 20)), null]
    expect(encounterOf(trace('enu', values))).toEqual([15, 26])
    expect(encounterOf(trace('enu', [null, null]))).toEqual([0, 2])
  })
  it('lie on one scale for both directions', () => {
    const scale = scaleOf([{ east: 0, north: 0 }, { east: 100, north: 10 }], 500, 300, 40, 30)
    const across = scale.x({ east: 100, north: 0 }) - scale.x({ east: 0, north: 0 })
    const up = scale.y({ east: 0, north: 0 }) - scale.y({ east: 0, north: 100 })
    expect(across).toBeCloseTo(up, 9)
    expect(across).toBeCloseTo(100 * scale.ratio, 9)
    expect(scale.x({ east: 0, north: 0 })).toBeGreaterThan(40)
    expect(scale.x({ east: 100, north: 0 })).toBeLessThan(488)
  })
  it('have a scale even when there is nothing to show', () => {
    expect(scaleOf([], 500, 300, 40, 30).ratio).toBeGreaterThan(0)
  })
})
