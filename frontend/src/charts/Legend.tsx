// A legend whose entries toggle their lines.
import { clsx } from 'clsx'
import { useState } from 'react'
import { Mark } from '../ui/MethodMark'
import { figures } from '../ui/styles'
import styles from './charts.module.css'

export interface Key {
  key: string
  label: string
  colour?: string
  method?: string
  dashed?: boolean
  /** Always shown. */
  fixed?: boolean
}

export function useHidden(): [ReadonlySet<string>, (key: string) => void] {
  const [hidden, setHidden] = useState<ReadonlySet<string>>(new Set())
  const toggle = (key: string) =>
    setHidden((before) => {
      const after = new Set(before)
      if (!after.delete(key)) after.add(key)
      return after
    })
  return [hidden, toggle]
}

interface LegendProps {
  keys: readonly Key[]
  hidden: ReadonlySet<string>
  onToggle: (key: string) => void
}

export function Legend({ keys, hidden, onToggle }: LegendProps) {
  return (
    <div className={figures.lg}>
      {keys.map((key) => {
        const content = (
          <>
            <Swatch of={key} />
            {key.label}
          </>
        )
        return key.fixed ? (
          <span key={key.key} className={figures.k}>
            {content}
          </span>
        ) : (
          <button
            key={key.key}
            type="button"
            className={figures.k}
            aria-pressed={!hidden.has(key.key)}
            onClick={() => onToggle(key.key)}
          >
            {content}
          </button>
        )
      })}
    </div>
  )
}

function Swatch({ of }: { of: Key }) {
  if (of.method) return <Mark method={of.method} />
  return <span data-swatch className={of.dashed ? clsx(styles.sw, styles.da) : styles.sw} style={{ borderColor: `var(${of.colour})` }} />
}
