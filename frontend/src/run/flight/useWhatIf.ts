// The what-if of a run's page: parameters, result, and synchronisation with address and 3D view.
// Start reading at `useWhatIf`.
import { useCallback, useEffect, useEffectEvent, useMemo, useRef, useState } from 'react'
import { evaluateCase, simulateFlight } from '../../api/calls'
import { hasScenario } from '../../api/campaign'
import { Refusal } from '../../api/problems'
import type { CaseAnswer, FlightAnswer } from '../../client'
import type { RunData } from '../data/data'
import { useAddress } from '../data/useAddress'
import { refusedFor, type View } from './view'
import { NOMINAL } from '../data/chosen'
import { caseOf, QUICK, readWhatIf, requestOf, type WhatIf, written } from './whatif'

/** Debounce interval of address changes [ms], which browsers limit. */
const STILL = 500
/** Retry interval after being superseded by another page [ms]. */
const AGAIN = 500

export interface WhatIfState {
  /** Null while it is closed. */
  whatIf: WhatIf | null
  /** The newest result; that of earlier values while a request is pending. */
  answer: FlightAnswer | CaseAnswer | null
  /** The reason why there is no flight. */
  refused: string | null
  /** Whether a simulation is pending. */
  busy: boolean
  /** Whether the values are simulated as they change; a simulator only if an evaluation is quick. */
  follows: boolean
  /** Whether the result is that of other values. */
  stale: boolean
  /** The measured time of an evaluation of a simulator [s]; null before the first one. */
  seconds: number | null
  /** Evaluates the values now. */
  evaluate: () => void
  change: (next: WhatIf | null) => void
  /** Opens it with the parameters of the displayed flight, or closes it. */
  toggle: () => void
}

export function useWhatIf(data: RunData, view: View): WhatIfState {
  const [address, write] = useAddress(data.run.id)
  const { parameters, findings, chosen } = data
  const known = useMemo(() => ({ parameters, findings }), [parameters, findings])
  const addressed = readWhatIf(address, known)
  const inAddress = JSON.stringify(addressed)
  const [whatIf, setWhatIf] = useState(addressed)
  /** The last address and pending changes, which may arrive late: any other value came by a
   *  link or a step back. */
  const [before, setBefore] = useState(inAddress)
  const [own, setOwn] = useState<readonly string[]>([inAddress])
  if (inAddress !== before) {
    setBefore(inAddress)
    if (!own.includes(inAddress)) setWhatIf(addressed)
    if (own[own.length - 1] === inAddress) setOwn([inAddress])
  }

  useWritten(whatIf, inAddress, (next) => {
    setOwn((written) => [...written, JSON.stringify(next)])
    write(written(next))
  })
  const flies = hasScenario(data.campaign)
  const flight = useFlight(data.run.id, whatIf, view, flies)

  useDrawn(view, whatIf, flies ? flight.answer : null, known)
  const open = whatIf !== null
  const toggle = useCallback(() => {
    const like = findings.some(({ label }) => label === chosen) ? chosen : NOMINAL
    setWhatIf(open ? null : { like, set: {}, seed: null })
  }, [open, findings, chosen])
  return { whatIf, ...flight, change: setWhatIf, toggle }
}

/** Writes it into the address after the debounce interval. */
function useWritten(whatIf: WhatIf | null, inAddress: string, write: (next: WhatIf | null) => void): void {
  const writeNow = useEffectEvent(write)
  const text = JSON.stringify(whatIf)
  useEffect(() => {
    if (text === inAddress) return
    // Opening and closing are written immediately, so that a copied link has them.
    const opened = (text === 'null') !== (inAddress === 'null')
    const timer = setTimeout(() => writeNow(JSON.parse(text) as WhatIf | null), opened ? 0 : STILL)
    return () => clearTimeout(timer)
  }, [text, inAddress])
}

type Simulated = Pick<WhatIfState, 'answer' | 'refused' | 'busy' | 'follows' | 'stale' | 'seconds' | 'evaluate'>

/** Simulates the newest values: one request at a time; superseded values are skipped. */
function useFlight(run: string, whatIf: WhatIf | null, view: View, flies: boolean): Simulated {
  const [answer, setAnswer] = useState<FlightAnswer | CaseAnswer | null>(null)
  const [refused, setRefused] = useState<string | null>(null)
  const [busy, setBusy] = useState(false)
  const [timed, setTimed] = useState<{ run: string; seconds: number } | null>(null)
  /** The values of the last result or refusal. */
  const [of, setOf] = useState('')
  const wanted = useRef<WhatIf | null>(null)
  const running = useRef(false)
  /** The values that were requested last. */
  const request = useRef('')
  const text = JSON.stringify(whatIf)
  const key = `${run} ${view.key} ${text}`
  const seconds = timed?.run === run ? timed.seconds : null
  const follows = flies || (seconds !== null && seconds <= QUICK)
  const start = useCallback(
    (next: string) => {
      request.current = `${run} ${view.key} ${next}`
      wanted.current = JSON.parse(next) as WhatIf | null
      if (wanted.current === null) {
        setAnswer(null)
        setRefused(null)
        return
      }
      if (running.current) return
      running.current = true
      setBusy(true)
      const simulated = (values: WhatIf): Promise<FlightAnswer | CaseAnswer> =>
        flies ? simulateFlight(run, requestOf(values, view.key)) : evaluateCase(run, caseOf(values, view.key))
      const work = async () => {
        for (let done: WhatIf | null = null; wanted.current !== null && done !== wanted.current; ) {
          const values: WhatIf = wanted.current
          const outcome = await simulated(values).catch(refusedFor)
          if (outcome instanceof Refusal && outcome.status === 409 && wanted.current === values) {
            await new Promise((resolve) => setTimeout(resolve, AGAIN))
            continue
          }
          done = values
          if (wanted.current === null) break
          if (outcome instanceof Refusal) setAnswer(null)
          else setAnswer(outcome)
          if (!(outcome instanceof Refusal) && 'seconds' in outcome) setTimed({ run, seconds: outcome.seconds })
          setRefused(outcome instanceof Refusal ? outcome.message : null)
          setOf(JSON.stringify(values))
        }
        running.current = false
        setBusy(false)
      }
      void work()
    },
    [run, view, flies],
  )
  useEffect(() => {
    if ((follows || text === 'null') && request.current !== key) start(text)
  }, [text, key, follows, start])
  const evaluate = useCallback(() => start(text), [start, text])
  return { answer, refused, busy, follows, stale: of !== text, seconds, evaluate }
}

/** Draws the flight in a view that was opened after the simulation, and hides it when the what-if closes. */
function useDrawn(view: View, whatIf: WhatIf | null, answer: WhatIfState['answer'], { parameters }: Pick<RunData, 'parameters'>): void {
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
