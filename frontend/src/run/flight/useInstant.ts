// Synchronises instant and camera between address and 3D view.
import { useEffect, useRef } from 'react'
import { useAddress } from '../data/useAddress'
import type { View } from './view'
import { type Place, shownPlace } from '../data/viewChange'

/** Debounce interval of address changes [ms], which browsers limit. */
const STILL = 500

/** Synchronises both while the page is open; records the last values sent, to avoid feedback. */
export function useInstant(view: View, id: string): void {
  const [{ t, cam }, change] = useAddress(id)
  /** The values of the address that were sent to the view. */
  const sent = useRef<Place>({ time: t, camera: cam })

  useEffect(() => {
    const before = sent.current
    sent.current = { time: t, camera: cam }
    if (t !== undefined && t !== before.time) view.steer({ time: t })
    if (cam !== undefined && cam !== before.camera) view.steer({ camera: cam })
  }, [t, cam, view])

  useEffect(() => {
    /** The default initial state, which need not be in the address. */
    let opened: Place | null = null
    let timer: ReturnType<typeof setTimeout> | undefined
    const write = () => {
      const place = shownPlace(view.known.shown)
      if (!place || view.known.shown?.playing) return
      const { time, camera } = sent.current
      if (time === undefined && place.time === opened?.time) delete place.time
      if (camera === undefined && place.camera === opened?.camera) delete place.camera
      if (place.time === time && place.camera === camera) return
      sent.current = place
      change({ t: place.time, cam: place.camera })
    }
    const heard = () => {
      opened ??= shownPlace(view.known.shown)
      clearTimeout(timer)
      if (view.known.shown) timer = setTimeout(write, STILL)
    }
    const end = view.subscribe(heard)
    return () => {
      clearTimeout(timer)
      end()
    }
  }, [view, change])
}
