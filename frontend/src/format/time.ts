// Times of day and ages, from seconds since 1970, in the browser's own time zone.

const clock = new Intl.DateTimeFormat('en-GB', { hour: '2-digit', minute: '2-digit' })
const day = new Intl.DateTimeFormat('en-GB', { day: 'numeric', month: 'short' })
const full = new Intl.DateTimeFormat('en-GB', {
  day: 'numeric',
  month: 'short',
  year: 'numeric',
  hour: '2-digit',
  minute: '2-digit',
  second: '2-digit',
})

/** For a table: minutes ago within the hour, the time today, else the day. */
export function when(time: number, now = Date.now() / 1000): string {
  const age = now - time
  if (age < 45) return 'just now'
  if (age < 3570) return `${Math.max(1, Math.round(age / 60))} min ago`
  const date = new Date(time * 1000)
  if (date.toDateString() === new Date(now * 1000).toDateString()) return clock.format(date)
  if (date.getFullYear() === new Date(now * 1000).getFullYear()) return day.format(date)
  return `${day.format(date)} ${date.getFullYear()}`
}

/** The day and the time in full. */
export const moment = (time: number): string => full.format(new Date(time * 1000))

/** For a heading: "Today 10:41" or "19 Nov 10:41". */
export function dayAndClock(time: number, now = Date.now() / 1000): string {
  const date = new Date(time * 1000)
  const today = date.toDateString() === new Date(now * 1000).toDateString()
  return `${today ? 'Today' : day.format(date)} ${clock.format(date)}`
}

/** A length of time in its largest unit: 48 s, 3 min, 2 h, 5 days. */
export function age(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds))
  if (whole < 120) return `${whole} s`
  if (whole < 7200) return `${Math.floor(whole / 60)} min`
  if (whole < 172_800) return `${Math.floor(whole / 3600)} h`
  return `${Math.floor(whole / 86_400)} days`
}

/** RFC 3339 in the reader's own time zone, to the second: 2026-11-22T10:41:07+01:00. */
export function rfc3339(time: number): string {
  const date = new Date(Math.floor(time) * 1000)
  const two = (value: number) => String(value).padStart(2, '0')
  const away = -date.getTimezoneOffset()
  const offset = `${away < 0 ? '-' : '+'}${two(Math.floor(Math.abs(away) / 60))}:${two(Math.abs(away) % 60)}`
  return `${new Date(date.getTime() + away * 60_000).toISOString().slice(0, 19)}${offset}`
}

/** The name of the reader's time zone. */
export const zone = (): string => Intl.DateTimeFormat().resolvedOptions().timeZone
