// A canvas for data under an SVG for axes and ranges, both at the size of the holder.
import { type ReactNode, useLayoutEffect, useRef } from 'react'
import { prepared } from './paint'
import styles from './space.module.css'

interface LayerProps {
  width: number
  height: number
  label: string
  /** Its identity says when to draw anew. */
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
      <svg className="ch" width={width} height={height} role="group" aria-label={label}>
        {children}
      </svg>
    </div>
  )
}
