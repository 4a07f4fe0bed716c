// The what-if of a run's page: parameters, result, and synchronisation with address and 3D view.
// Start reading at `useWhatIf`.
import { useCallback, useEffect, useMemo, useRef, useState, useSyncExternalStore } from 'react'
import { simulateFlight } from '../../api/calls'
import { Refusal } from '../../api/problems'
import type { FlightAnswer } from '../../client'
import type { RunData } from '../data/data'
import { useAddress } from '../data/useAddress'
import type { View } from './view'
import { NOMINAL } from '../data/chosen'
import { readWhatIf, requestOf, takenFrom, type WhatIf, written } from './whatif'

/** Debounce interval of address changes [ms], which browsers limit. */
const STILL = 500
/** Retry interval after being superseded by another page [ms]. */
const AGAIN = 500

export interface WhatIfState {
  /** Null while it is closed. */
  whatIf: WhatIf | null
  /** The newest result; that of earlier values while a request is pending. */
  answer: FlightAnswer | null
  /** The reason why there is no flight. */
  refused: string | null
  /** Whether a simulation is pending. */
  busy: boolean
  change: (next: WhatIf | null) => void
  /** Opens it with the parameters of the displayed flight, or closes it. */
  toggle: () => void
}

export function useWhatIf(data: RunData, view: View): WhatIfState {
  const [address, write] = useAddress(data.run.id)
  const { parameters, findings, chosen } = data
  const known = useMemo(() => ({ parameters, findings }), [parameters, findings])
  const asked = readWhatIf(address, known)
  const inAddress = JSON.stringify(asked)
  const [whatIf, setWhatIf] = useState(asked)
  /** The last address and pending changes, which may arrive late: any other value came by a
   *  link or a step back. */
  const [before, setBefore] = useState(inAddress)
  const [own, setOwn] = useState<readonly string[]>([inAddress])
  if (inAddress !== before) {
    setBefore(inAddress)
    if (!own.includes(inAddress)) setWhatIf(asked)
    if (own[own.length - 1] === inAddress) setOwn([inAddress])
  }
  const change = useCallback((next: WhatIf | null) => setWhatIf(next), [])

  useWritten(whatIf, inAddress, (next) => {
    setOwn((written) => [...written, JSON.stringify(next)])
    write(written(next))
  })
  const flight = useFlight(data.run.id, whatIf, view)

  // An evaluation picked in the parameter space is adopted by the page.
  const shown = useSyncExternalStore(view.subscribe, () => view.known.shown)
  const taken = shown ? takenFrom(shown, known) : null
  const text = JSON.stringify(taken)
  const [last, setLast] = useState('null')
  if (text !== last) {
    setLast(text)
    if (taken) setWhatIf(taken)
  }

  useDrawn(view, whatIf, flight.answer, known)
  const open = whatIf !== null
  const toggle = useCallback(() => {
    const like = findings.some(({ label }) => label === chosen) ? chosen : NOMINAL
    setWhatIf(open ? null : { like, set: {}, seed: null })
  }, [open, findings, chosen])
  return { whatIf, ...flight, change, toggle }
}

/** Writes it into the address after the debounce interval. */
function useWritten(whatIf: WhatIf | null, inAddress: string, write: (next: WhatIf | null) => void): void {
  const latest = useRef(write)
  useEffect(() => {
    latest.current = write
  })
  const text = JSON.stringify(whatIf)
  useEffect(() => {
    if (text === inAddress) return
    // Opening and closing are written immediately, so that a copied link has them.
    const opened = (text === 'null') !== (inAddress === 'null')
    const timer = setTimeout(() => latest.current(JSON.parse(text) as WhatIf | null), opened ? 0 : STILL)
    return () => clearTimeout(timer)
  }, [text, inAddress])
}

/** Simulates the newest values: one request at a time; superseded values are skipped. */
function useFlight(run: string, whatIf: WhatIf | null, view: View): Pick<WhatIfState, 'answer' | 'refused' | 'busy'> {
  const [answer, setAnswer] = useState<FlightAnswer | null>(null)
  const [refused, setRefused] = useState<string | null>(null)
  const [busy, setBusy] = useState(false)
  const wanted = useRef<WhatIf | null>(null)
  const running = useRef(false)
  const text = JSON.stringify(whatIf)
  useEffect(() => {
    wanted.current = JSON.parse(text) as WhatIf | null
    if (wanted.current === null) {
      setAnswer(null)
      setRefused(null)
      return
    }
    if (running.current) return
    running.current = true
    setBusy(true)
    const work = async () => {
      for (let done: WhatIf | null = null; wanted.current !== null && done !== wanted.current; ) {
        const asked: WhatIf = wanted.current
        const given = await simulateFlight(run, requestOf(asked, view.key)).catch(refusalFor)
        if (given instanceof Refusal && given.status === 409 && wanted.current === asked) {
          await new Promise((resolve) => setTimeout(resolve, AGAIN))
          continue
        }
        done = asked
        if (wanted.current === null) break
        if (given instanceof Refusal) setAnswer(null)
        else setAnswer(given)
        setRefused(given instanceof Refusal ? given.message : null)
      }
      running.current = false
      setBusy(false)
    }
    void work()
  }, [run, text, view])
  return { answer, refused, busy }
}

/** Draws the flight in a view that was opened after the simulation, and hides it when the what-if closes. */
function useDrawn(view: View, whatIf: WhatIf | null, answer: FlightAnswer | null, { parameters }: Pick<RunData, 'parameters'>): void {
  const open = whatIf !== null
  const was = useRef(open)
  useEffect(() => {
    if (was.current !== open) view.steer({ layers: { what_if: open } })
    was.current = open
  }, [view, open])
  useEffect(() => {
    if (!answer || answer.drawn !== null) return
    const uncertain = Object.fromEntries(parameters.map(({ path, nominal }) => [path, answer.parameters[path] ?? nominal]))
    view.steer({ what_if: uncertain, what_if_seed: answer.seed })
  }, [view, answer, parameters])
}

const refusalFor = (error: unknown): Refusal =>
  error instanceof Refusal ? error : new Refusal(0, 'No response', 'The service does not respond.')
