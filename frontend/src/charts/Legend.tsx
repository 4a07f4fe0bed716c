// A legend whose entries toggle their lines.
import { clsx } from 'clsx'
import { type ReactNode, useState } from 'react'
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
      {keys.map((key) => (
        <Entry key={key.key} on={!hidden.has(key.key)} onToggle={key.fixed ? undefined : () => onToggle(key.key)}>
          <Swatch of={key} />
          {key.label}
        </Entry>
      ))}
    </div>
  )
}

interface EntryProps {
  on: boolean
  onToggle: (() => void) | undefined
  title?: string
  children: ReactNode
}

/** An entry of a legend: a button, unless it is always shown. */
export const Entry = ({ on, onToggle, title, children }: EntryProps) =>
  onToggle ? (
    <button type="button" className={figures.k} aria-pressed={on} title={title} onClick={onToggle}>
      {children}
    </button>
  ) : (
    <span className={figures.k}>{children}</span>
  )

function Swatch({ of }: { of: Key }) {
  if (of.method) return <Mark method={of.method} />
  return <span data-swatch className={of.dashed ? clsx(styles.sw, styles.da) : styles.sw} style={{ borderColor: `var(${of.colour})` }} />
}
