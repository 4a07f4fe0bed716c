// Times as British English writes them, which is what a browser's own formats say.
import { expect, test } from 'vitest'
import { dayAndClock, moment, when } from './time'

const DAY = { day: 'numeric', month: 'short' } as const
const CLOCK = { hour: '2-digit', minute: '2-digit' } as const
const written = (time: number, how: Intl.DateTimeFormatOptions) => new Intl.DateTimeFormat('en-GB', how).format(new Date(1000 * time))

/** One in every month, at another time of day, over two years. */
const TIMES = Array.from({ length: 24 }, (_, k) => 1.7e9 + k * 2.63e6 + k * k * 3607)

test.each(TIMES)('%d is written as by the browser', (time) => {
  const later = time + 2 * 366 * 86_400
  expect(moment(time)).toBe(written(time, { ...DAY, ...CLOCK, year: 'numeric', second: '2-digit' }))
  expect(dayAndClock(time, later)).toBe(`${written(time, DAY)} ${written(time, CLOCK)}`)
  expect(when(time, later)).toBe(written(time, { ...DAY, year: 'numeric' }))
})

test('a time of the same day has no date, one within the hour its age', () => {
  const noon = new Date(2026, 10, 19, 12).getTime() / 1000
  expect(dayAndClock(noon, noon + 3600)).toBe('Today 12:00')
  expect(when(noon, noon + 3600)).toBe('12:00')
  expect(when(noon, noon + 600)).toBe('10 min ago')
})
