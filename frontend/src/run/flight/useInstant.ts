// The address and the 3D view agree on the instant and the camera: what is changed in one is in the other.
// Start reading at `useInstant`.
import { useEffect, useRef } from 'react'
import { useAddress } from '../data/useAddress'
import type { View } from './view'
import type { Place } from '../data/viewChange'

/** The address goes along once the view has stood still for so long [ms]: browsers count its changes. */
const STILL = 500

/** Keeps both alike for as long as the page is there; without end, because each knows what the other has said. */
export function useInstant(view: View, id: string): void {
  const [{ t, cam }, change] = useAddress(id)
  /** What the address says, as far as the view knows of it. */
  const said = useRef<Place>({ time: t, camera: cam })
  const latest = useRef(change)
  useEffect(() => {
    latest.current = change
  })

  useEffect(() => {
    const before = said.current
    said.current = { time: t, camera: cam }
    if (t !== undefined && t !== before.time) view.steer({ time: t })
    if (cam !== undefined && cam !== before.camera) view.steer({ camera: cam })
  }, [t, cam, view])

  useEffect(() => {
    /** Where it opened without being asked to: that need not stand in the address. */
    let opened: Place | null = null
    let timer: ReturnType<typeof setTimeout> | undefined
    const write = () => {
      const place = placeOf(view)
      if (!place || view.known.shown?.playing) return
      const { time, camera } = said.current
      if (time === undefined && place.time === opened?.time) delete place.time
      if (camera === undefined && place.camera === opened?.camera) delete place.camera
      if (place.time === time && place.camera === camera) return
      said.current = place
      latest.current({ t: place.time, cam: place.camera })
    }
    const heard = () => {
      opened ??= placeOf(view)
      clearTimeout(timer)
      if (view.known.shown) timer = setTimeout(write, STILL)
    }
    const end = view.subscribe(heard)
    return () => {
      clearTimeout(timer)
      end()
    }
  }, [view])
}

const placeOf = (view: View): Place | null => {
  const { shown } = view.known
  return shown && { time: Number(shown.time.toFixed(2)), ...(shown.camera && { camera: shown.camera }) }
}
