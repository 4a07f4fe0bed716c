// A legend whose entries switch their lines off and on.
import { useState } from 'react'
import { Mark } from '../ui/MethodMark'

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
    <div className="lg">
      {keys.map((key) => {
        const swatch = key.method ? (
          <Mark method={key.method} />
        ) : (
          <span className={key.dashed ? 'sw da' : 'sw'} style={{ borderColor: `var(${key.colour})` }} />
        )
        return key.fixed ? (
          <span key={key.key} className="k">
            {swatch}
            {key.label}
          </span>
        ) : (
          <button
            key={key.key}
            type="button"
            className="k"
            aria-pressed={!hidden.has(key.key)}
            onClick={() => onToggle(key.key)}
          >
            {swatch}
            {key.label}
          </button>
        )
      })}
    </div>
  )
}
