// A line chart: uPlot under React, with axis titles, crosshair and values; redrawn when theme, size or data change.
import { clsx } from 'clsx'
import { useEffect, useEffectEvent, useLayoutEffect, useRef, useState } from 'react'
import uPlot from 'uplot'
import 'uplot/dist/uPlot.min.css'
import { useTheme } from '../theme/useTheme'
import { optionsFor } from './options'
import { type PlotSpec, valueText } from './spec'
import { figures } from '../ui/styles'
import styles from './charts.module.css'

const NOTHING: ReadonlySet<string> = new Set()

/** A chart is drawn once it is this close to the window. */
const NEAR = '400px'

/** Abscissa of the crosshair while no pointer is on a chart. */
export interface Standing {
  subscribe: (listener: () => void) => () => void
  time: () => number | null
}

interface Cursor {
  at: number
  /** True while a pointer is on a chart. */
  pointed: boolean
  left: number
  top: number
  flip: boolean
}

interface PlotProps {
  spec: PlotSpec
  hidden?: ReadonlySet<string>
  /** Called with each x under the pointer. */
  onCross?: (x: number) => void
  standing?: Standing
}

export function Plot({ spec, hidden = NOTHING, onCross, standing }: PlotProps) {
  const theme = useTheme()
  const holder = useRef<HTMLDivElement>(null)
  const plot = useRef<uPlot | null>(null)
  /** Whether it has been near the window; it is drawn from then on. */
  const reached = useRef(false)
  const [cursor, setCursor] = useState<Cursor | null>(null)
  const now = useEffectEvent(() => ({ spec, hidden, onCross }))

  // uPlot is recreated only when its structure changes; data and size update the existing instance.
  const structure = [
    theme,
    spec.xLog,
    spec.height,
    spec.sync,
    spec.xTime,
    ...spec.lines.map((line) => `${line.key} ${line.colour} ${hidden.has(line.key)}`),
  ].join('|')

  useLayoutEffect(() => {
    const element = holder.current
    if (!element) return
    const read = () => now().spec
    let crossed: number | undefined
    let placing = false
    let settled = 0
    const stand = () => {
      const built = plot.current
      const x = standing?.time()
      if (!built || placing || x === undefined || pointed()) return
      placing = true
      const [low, high] = [built.scales.x?.min ?? 0, built.scales.x?.max ?? 0]
      const seen = x !== null && x >= low && x <= high
      built.setCursor(seen ? { left: built.valToPos(x, 'x'), top: 0 } : { left: -10, top: -10 }, true)
      placing = false
    }
    const crossing = (u: uPlot) => {
      const cursor = cursorOf(u, read())
      setCursor(cursor)
      // Only under a pointer: uPlot also moves its cursor when data or size change.
      const x = cursor && u.over.matches(':hover') ? read().x[cursor.at] : undefined
      if (x !== undefined && x !== crossed) now().onCross?.(x)
      crossed = x
      stand()
    }
    const build = (width: number) => {
      const built = new uPlot(optionsFor(read, () => now().hidden, width, crossing), dataOf(read()), element)
      if (document.fonts.status === 'loading')
        void document.fonts.ready.then(() => plot.current === built && built.redraw(false, true))
      return built
    }
    // The observer reports the width before the first paint, once for all charts. Reading it here would force a layout
    // for each of them.
    const sized = new ResizeObserver(([entry]) => {
      const width = Math.floor(entry?.contentRect.width ?? 0)
      if (width <= 40) return
      if (!plot.current) plot.current = build(width)
      else if (width !== plot.current.width) plot.current.setSize({ width, height: read().height })
      stand()
      // Charts of one key move each other's crosshair while they are resized one after another.
      settled = requestAnimationFrame(stand)
    })
    // Most charts of a page are below the window, and many are never scrolled to.
    const near = new IntersectionObserver(
      ([entry]) => {
        if (!entry?.isIntersecting) return
        near.disconnect()
        reached.current = true
        sized.observe(element)
      },
      { rootMargin: NEAR },
    )
    if (reached.current) sized.observe(element)
    else near.observe(element)
    const printed = () => {
      plot.current ??= build(element.clientWidth)
    }
    addEventListener('beforeprint', printed)
    const end = standing?.subscribe(stand)
    return () => {
      near.disconnect()
      sized.disconnect()
      removeEventListener('beforeprint', printed)
      cancelAnimationFrame(settled)
      end?.()
      plot.current?.destroy()
      plot.current = null
    }
  }, [structure, standing])

  useEffect(() => {
    plot.current?.setData(dataOf(spec), true)
  }, [spec])

  return (
    <figure>
      {spec.yTitle && (
        <div className="sec micro">
          {spec.yTitle}
          {spec.readout && cursor && <Readout at={cursor.at} spec={spec} hidden={hidden} />}
        </div>
      )}
      <div className={figures.plot} role="img" aria-label={spec.label} style={{ height: spec.height }} ref={holder}>
        {cursor && !cursor.pointed && !spec.readout && <Flag left={cursor.left} text={spec.xText(spec.x[cursor.at] as number)} />}
        {cursor?.pointed && !spec.readout && <Tip cursor={cursor} spec={spec} hidden={hidden} />}
      </div>
      {spec.xTitle && <figcaption className={clsx('sec micro', styles.xtitle)}>{spec.xTitle}</figcaption>}
    </figure>
  )
}

function dataOf(spec: PlotSpec): uPlot.AlignedData {
  return [[...spec.x], ...spec.lines.map((line) => [...line.y])]
}

/** Whether a pointer is on any chart of the same key, since these share a crosshair. */
const pointed = (): boolean => document.querySelector('.u-over:hover') !== null

function cursorOf(u: uPlot, spec: PlotSpec): Cursor | null {
  const { idx, left, top } = u.cursor
  if (idx === null || idx === undefined || left === undefined || left < 0) return null
  const x = spec.x[idx]
  if (x === undefined) return null
  const at = u.valToPos(x, 'x') + u.over.offsetLeft
  return { at: idx, pointed: pointed(), left: at, top: (top ?? 0) + u.over.offsetTop, flip: at > u.width / 2 }
}

/** The values at the crosshair in the colours of their lines, next to the title. */
function Readout({ at, spec, hidden }: { at: number; spec: PlotSpec; hidden: ReadonlySet<string> }) {
  return (
    <span className={clsx('m tn', figures.readout)} data-readout>
      {spec.lines.map((line) => {
        const value = line.y[at]
        return hidden.has(line.key) || typeof value !== 'number' ? null : (
          <span key={line.key} title={line.label}>
            <span data-swatch className={styles.sw} style={{ borderTop: `2px solid var(${line.colour})` }} />
            {valueText(spec, line, at)}
          </span>
        )
      })}
    </span>
  )
}

/** The label of a fixed crosshair, below it. */
function Flag({ left, text }: { left: number; text: string }) {
  return (
    <span className={clsx('sec tn nw', figures.flag)} data-float="flag" style={{ left }} aria-hidden>
      {text}
    </span>
  )
}

function Tip({ cursor, spec, hidden }: { cursor: Cursor; spec: PlotSpec; hidden: ReadonlySet<string> }) {
  const lines = spec.lines.filter((line) => !hidden.has(line.key) && typeof line.y[cursor.at] === 'number')
  if (lines.length === 0) return null
  const place = cursor.flip ? { right: `calc(100% - ${cursor.left - 12}px)` } : { left: cursor.left + 12 }
  return (
    <div className={clsx('tn nw', figures.tip)} data-float="tip" style={{ ...place, top: Math.max(0, cursor.top - 30) }}>
      <div className="b">{spec.xText(spec.x[cursor.at] as number)}</div>
      <dl>
        {lines.map((line) => (
          <div key={line.key} style={{ display: 'contents' }}>
            <dt>
              <span data-swatch className={styles.sw} style={{ width: 10, borderTop: `2px solid var(${line.colour})` }} />
              {line.label}
            </dt>
            <dd>{valueText(spec, line, cursor.at)}</dd>
          </div>
        ))}
      </dl>
    </div>
  )
}
