// A canvas for data below an SVG for axes and ranges, both of the container's size.
import { type ReactNode, useLayoutEffect, useRef } from 'react'
import { prepared } from './paint'
import { figures } from '../../ui/styles'
import styles from './space.module.css'

interface LayerProps {
  width: number
  height: number
  label: string
  /** A new identity triggers a redraw. */
  paint: (ctx: CanvasRenderingContext2D) => void
  children: ReactNode
}

export function Layer({ width, height, label, paint, children }: LayerProps) {
  const canvas = useRef<HTMLCanvasElement>(null)
  useLayoutEffect(() => {
    const ctx = canvas.current && prepared(canvas.current, width, height)
    if (ctx) paint(ctx)
  }, [paint, width, height])
  return (
    <div className={styles.layer} style={{ height }}>
      <canvas ref={canvas} aria-hidden="true" style={{ width, height }} />
      <svg className={figures.ch} width={width} height={height} role="group" aria-label={label}>
        {children}
      </svg>
    </div>
  )
}
