// Changes and addresses of a 3D view, as functions of its state.
import type { ViewChange, ViewState } from '../../client'
import { at } from '../../format/root'

export type Camera = NonNullable<ViewState['camera']>
export const CAMERAS: readonly Camera[] = ['overview', 'encounter', 'top', 'side', 'chase', 'intruder']

/** The state that the page requires of its view; sent again to a reopened one. */
export type Wanted = Required<Pick<ViewChange, 'flight' | 'theme'>>

export interface Place {
  time?: number
  camera?: Camera
}

/** The displayed instant, for an address. */
export const shownPlace = (shown: ViewState | null): Place | null =>
  shown && { time: Number(shown.time.toFixed(2)), ...(shown.camera && { camera: shown.camera }) }

/** Merges two changes: a time replaces earlier ones, steps are added. */
export function merged(before: ViewChange, next: ViewChange): ViewChange {
  const { time, step, closest, passing, ...rest } = { ...before, ...next }
  if (before.layers && next.layers) rest.layers = { ...before.layers, ...next.layers }
  if (next.camera) delete rest.eye
  if (next.closest) return { ...rest, closest: true }
  if (typeof next.time === 'number')
    return { ...rest, time: next.time, ...(next.step && { step: next.step }), ...(next.passing && { passing: true }) }
  if (!next.step) {
    const kept = { ...(step != null && { step }), ...(closest && { closest }), ...(passing && { passing }) }
    return { ...rest, ...(time != null && { time }), ...kept }
  }
  // A step from the closest approach cannot be expressed in one change: only the step is sent.
  return { ...rest, ...(time != null && { time }), step: (before.step ?? 0) + next.step }
}

/** The full state of a view, for its replacement; its what-if only if the view can simulate it. */
export function again(last: ViewState, simulates = true): ViewChange {
  const { flight, theme, time, camera, eye, playing, speed, panel, layers, what_if, what_if_seed } = last
  return {
    flight,
    theme,
    time,
    playing,
    speed,
    panel,
    layers,
    ...(camera ? { camera } : eye && { eye }),
    ...(simulates && what_if && { what_if, what_if_seed }),
  }
}

/** The address of a view: its state is in the fragment, so that all views of a run share one cached page. */
export function addressOf(run: string, { flight, theme }: Wanted, { time, camera }: Place, key: string): string {
  const parts = [flight, ...(time === undefined ? [] : ['t', String(time)]), ...(camera ? ['cam', camera] : []), theme]
  return at(`/view/${run}/#${[...parts, 'key', key].join('/')}/`)
}
