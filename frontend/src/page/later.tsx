// Code that is loaded when it is first shown. Where it cannot be loaded only its own place says so, and loads it again on
// request and once the service answers: the rest of the page, and what was typed there, stay.
import { Component, type ComponentType, createElement, type FunctionComponent, type ReactNode, Suspense, use, useEffect, useRef, useState } from 'react'
import { pulse, useContact } from '../api/pulse'
import { Card } from '../ui/Card'
import { PageHead } from './PageHead'
import { Failed, Loading } from './Trouble'

/** Code that did not come. */
export class Missed extends Error {
  /** Lets the code be asked for again. */
  readonly forget: () => void

  constructor(cause: unknown, forget: () => void) {
    super('the code could not be loaded', { cause })
    this.forget = forget
  }
}

/** Loads the code ahead; a failure is reported where the component is shown. */
interface Ahead {
  preload: () => Promise<void>
}

/** Code by how it is loaded: components of one file come together. */
const known = new WeakMap<() => Promise<unknown>, Code<unknown>>()

class Code<M> {
  come: M | undefined
  coming: Promise<M> | undefined

  constructor(readonly load: () => Promise<M>) {}

  ask(): Promise<M> {
    return (this.coming ??= this.load().then(
      (module) => (this.come = module),
      (error: unknown) => {
        throw new Missed(error, () => (this.coming = undefined))
      },
    ))
  }
}

/** A component whose code comes later; within `Part`. Unlike that of React.lazy, its failure does not last for ever. */
export function later<M, K extends keyof M>(load: () => Promise<M>, name: K): M[K] & Ahead {
  const code = (known.get(load) ?? new Code(load)) as Code<M>
  known.set(load, code)
  const Later = (props: object) => createElement((code.come ?? use(code.ask()))[name] as ComponentType<object>, props)
  Later.preload = () => code.ask().then(() => undefined, (missed: Missed) => missed.forget())
  return Later as unknown as M[K] & Ahead
}

/** A page of the router whose code comes later. */
export function laterPage<M, K extends keyof M>(load: () => Promise<M>, name: K): FunctionComponent & Ahead {
  const Inner = later(load, name) as FunctionComponent & Ahead
  const Page = () => (
    <Part whole waiting={<Loading what="page" />}>
      <Inner />
    </Part>
  )
  Page.preload = Inner.preload
  return Page
}

interface PartProps {
  /** Shown until the code is there. */
  waiting?: ReactNode
  /** Whether it is the whole page, which is not the place of anything typed. */
  whole?: boolean
  /** What is around the line that tells the failure. */
  failed?: (line: ReactNode) => ReactNode
  children: ReactNode
}

/** The place of code that comes later. */
export class Part extends Component<PartProps, { error: unknown }> {
  override state = { error: null }

  static getDerivedStateFromError(error: unknown) {
    return { error }
  }

  override componentDidCatch(error: unknown) {
    if (error instanceof Missed) error.forget()
  }

  override render() {
    const { waiting, whole = false, failed = (line) => line, children } = this.props
    const error: unknown = this.state.error
    if (error === null) return <Suspense fallback={waiting}>{children}</Suspense>
    if (!(error instanceof Missed)) throw error as Error // of the code itself
    const line = <Missing missed={error} whole={whole} again={() => this.setState({ error: null })} />
    return whole ? (
      <>
        <PageHead title="This page could not be loaded" />
        <Card>{line}</Card>
      </>
    ) : (
      failed(line)
    )
  }
}

function Missing({ missed, whole, again }: { missed: Missed; whole: boolean; again: () => void }) {
  const [updated, setUpdated] = useState(false)
  const well = useContact().state === 'well'
  const before = useRef(well)
  useEffect(() => {
    if (well && !before.current) again()
    before.current = well
  }, [well, again])
  useEffect(() => {
    let shown = true
    void gone(missed).then((address) => {
      if (!shown || address === '') return
      if (whole && first(address)) location.reload()
      else setUpdated(true)
    })
    return () => void (shown = false)
  }, [missed, whole])
  if (updated) {
    const words = `Clearance was updated. ${whole ? 'Reload' : 'Save what you are writing, if anything, then reload'} this page.`
    return <Failed error={new Error(words)} retry={() => location.reload()} label="Reload this page" />
  }
  const words = `${whole ? 'Its code' : 'This part of the page'} could not be loaded.${well ? '' : ' It is loaded as soon as the service answers.'}`
  return <Failed error={new Error(words)} retry={again} />
}

/** The address of the code if the service answers without having it, as it does after an update; empty otherwise. */
export async function gone({ cause }: Missed): Promise<string> {
  const address = /https?:\S+\.js/.exec(String(cause))?.[0] ?? '' // not every browser names it
  const answer = address && (await fetch(address, { method: 'HEAD', cache: 'no-store' }).catch(() => null))
  if (answer && answer.status === 404) return address
  void pulse.check() // says at once if the service cannot be reached, and goes on asking
  return ''
}

/** Whether this tab is reloaded for this code for the first time: what stays missing does not reload it for ever. */
function first(address: string): boolean {
  try {
    if (sessionStorage.getItem('reloaded') === address) return false
    sessionStorage.setItem('reloaded', address)
    return true
  } catch {
    return false // without storage
  }
}
