// Ticks of an axis of time: round times of the reader's zone, in seconds since 1970, with their labels.

export interface TimeTick {
  at: number
  label: string
}

const [MINUTE, HOUR, DAY] = [60, 3600, 86_400]

/** Steps within a day [s]; longer ones are counted in days, then in months. */
const WITHIN = [1, 2, 5, 10, 15, 30, MINUTE, 2 * MINUTE, 5 * MINUTE, 10 * MINUTE, 15 * MINUTE, 30 * MINUTE, HOUR, 2 * HOUR, 3 * HOUR, 6 * HOUR, 12 * HOUR]
const DAYS = [1, 2, 7, 14]
const MONTHS = [1, 2, 3, 6, 12, 24, 60, 120]

/** The least step of which at most `about` fit into the range, and a label for each multiple of it in the range. */
export function timeTicks(low: number, high: number, about: number): TimeTick[] {
  if (!(high > low) || about < 1) return [{ at: low, label: text(low, true, DAY) }]
  const least = (high - low) / about
  const within = WITHIN.find((step) => step >= least)
  const days = DAYS.find((step) => step * DAY >= least)
  const months = MONTHS.find((step) => step * 30.44 * DAY >= least) ?? 120 * Math.ceil(least / (3652.5 * DAY))
  const found = within ? seconds(low, high, within) : days ? wholeDays(low, high, days) : wholeMonths(low, high, months)
  const step = within ?? (days ? DAY : 30 * DAY)
  return found.map((at, i) => ({ at, label: text(at, i === 0 || otherDay(at, found[i - 1] as number, step), step) }))
}

/** Multiples of a step since local midnight, so that they are round in the reader's zone. */
function seconds(low: number, high: number, step: number): number[] {
  const found: number[] = []
  for (let day = midnight(low); day <= high; day = midnight(day + 1.5 * DAY))
    for (let at = day; at < midnight(day + 1.5 * DAY) && at <= high; at += step) if (at >= low) found.push(at)
  return found
}

/** Midnights; days are counted from one that does not depend on the range, so that ticks stay when it moves. */
function wholeDays(low: number, high: number, step: number): number[] {
  const found: number[] = []
  for (let at = midnight(low); at <= high; at = midnight(at + 1.5 * DAY))
    if (at >= low && Math.round(at / DAY) % step === 0) found.push(at)
  return found
}

function wholeMonths(low: number, high: number, step: number): number[] {
  const found: number[] = []
  const first = new Date(low * 1000)
  const start = 12 * first.getFullYear() + first.getMonth()
  for (let month = start - (start % step); ; month += step) {
    const at = new Date(Math.floor(month / 12), month % 12, 1).getTime() / 1000
    if (at > high) return found
    if (at >= low) found.push(at)
  }
}

function midnight(time: number): number {
  const date = new Date(time * 1000)
  return new Date(date.getFullYear(), date.getMonth(), date.getDate()).getTime() / 1000
}

/** Whether a label must name its day (for steps in a day) or its year again. */
function otherDay(at: number, before: number, step: number): boolean {
  const [a, b] = [new Date(at * 1000), new Date(before * 1000)]
  return step < DAY ? a.toDateString() !== b.toDateString() : a.getFullYear() !== b.getFullYear()
}

const format = (options: Intl.DateTimeFormatOptions) => new Intl.DateTimeFormat('en-GB', options)
const DAY_OF = format({ day: 'numeric', month: 'short' })
const DAY_IN = format({ day: 'numeric', month: 'short', year: 'numeric' })
const MONTH_OF = format({ month: 'short' })
const MONTH_IN = format({ month: 'short', year: 'numeric' })
const CLOCK = format({ hour: '2-digit', minute: '2-digit' })
const EXACT = format({ hour: '2-digit', minute: '2-digit', second: '2-digit' })

/** `whole`: with the day, or for longer steps with the year. */
function text(at: number, whole: boolean, step: number): string {
  const date = new Date(at * 1000)
  if (step > DAY) return (whole ? MONTH_IN : MONTH_OF).format(date)
  if (step === DAY) return (whole ? DAY_IN : DAY_OF).format(date)
  if (whole && date.getTime() / 1000 === midnight(at)) return DAY_OF.format(date)
  const clock = (step < MINUTE ? EXACT : CLOCK).format(date)
  return whole ? `${DAY_OF.format(date)} ${clock}` : clock
}
