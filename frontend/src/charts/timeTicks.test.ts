// Ticks of an axis of time in the reader's zone.
import { expect, it } from 'vitest'
import { timeTicks } from './timeTicks'

const at = (year: number, month: number, day: number, hour = 0, minute = 0) => new Date(year, month, day, hour, minute).getTime() / 1000
const labels = (low: number, high: number, about = 8) => timeTicks(low, high, about).map(({ label }) => label)

it('names the day once, then the times', () => {
  expect(labels(at(2026, 10, 22, 9, 10), at(2026, 10, 22, 15, 0))).toEqual([
    '22 Nov 10:00', '11:00', '12:00', '13:00', '14:00', '15:00',
  ])
  expect(labels(at(2026, 10, 22, 20), at(2026, 10, 23, 5), 5)).toEqual(['22 Nov 20:00', '22:00', '23 Nov', '02:00', '04:00'])
})

it('counts days, then months, and names a year when it changes', () => {
  expect(labels(at(2026, 10, 28, 6), at(2026, 11, 3, 6))).toEqual(['29 Nov 2026', '30 Nov', '1 Dec', '2 Dec', '3 Dec'])
  expect(labels(at(2026, 9, 20), at(2027, 2, 20))).toEqual(['Nov 2026', 'Dec', 'Jan 2027', 'Feb'].concat('Mar'))
})

it('is bounded in number, in the range and increasing, for a second as for centuries', () => {
  for (const span of [1, 59, 3000, 90_000, 1e6, 4e7, 5e9])
    for (const about of [1, 3, 9]) {
      const ticks = timeTicks(1.795e9 + 0.25, 1.795e9 + 0.25 + span, about).map((tick) => tick.at)
      expect(ticks.length).toBeLessThanOrEqual(about * 2 + 2)
      expect(ticks.every((tick) => tick >= 1.795e9 && tick <= 1.795e9 + 0.25 + span)).toBe(true)
      expect(ticks).toEqual([...ticks].sort((a, b) => a - b))
    }
})

it('has one tick where nothing is apart', () => {
  expect(labels(at(2026, 0, 1), at(2026, 0, 1))).toEqual(['1 Jan 2026'])
})
