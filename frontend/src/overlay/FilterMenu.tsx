// A filter with multiple choice: a button with the current choice, and a list.
import { clsx } from 'clsx'
import { type ReactNode, useState } from 'react'
import type { Facet } from '../client'
import { count } from '../format/numbers'
import { Button } from '../ui/Button'
import { Menu, Pick, Picks } from './Menu'
import { fields, layout } from '../ui/styles'

interface FilterMenuProps {
  name: string
  options: readonly Facet[]
  /** Why there are no options yet, if they could not be loaded or are not there. */
  absent?: string
  value: readonly string[] | undefined
  onChange: (value: string[] | undefined) => void
  /** How an option is shown. */
  label?: (value: string) => ReactNode
}

const FEW = 8

export function FilterMenu({ name, options, absent, value = [], onChange, label = (text) => text }: FilterMenuProps) {
  const [query, setQuery] = useState('')
  // A chosen value can be deselected even if no run has it any more.
  const gone = value.filter((text) => !options.some((option) => option.value === text))
  const all = [...gone.map((text) => ({ value: text, runs: 0 })), ...options]
  const shown = all.filter((option) => option.value.toLowerCase().includes(query.toLowerCase()))
  const toggle = (text: string, on: boolean) => {
    const next = on ? [...value, text] : value.filter((other) => other !== text)
    onChange(next.length ? next : undefined)
  }
  const statement = value.length === 0 ? 'any' : value.length === 1 ? label(value[0] ?? '') : `${value.length} chosen`
  return (
    <Menu name={name} value={statement} on={value.length > 0}>
      {all.length > FEW && (
        <label className={fields.inp}>
          <input
            type="search"
            placeholder={`Find ${name.toLowerCase()}`}
            aria-label={`Find ${name.toLowerCase()}`}
            value={query}
            onChange={(event) => setQuery(event.target.value)}
          />
        </label>
      )}
      <Picks label={name}>
        {shown.map((option) => (
          <Pick key={option.value} on={value.includes(option.value)} onChange={(on) => toggle(option.value, on)}>
            <span className={clsx(layout.grow, layout.wrapAny)}>{label(option.value)}</span>
            <span className="mut tn">{count(option.runs)}</span>
          </Pick>
        ))}
        {shown.length === 0 && <p className="small mut">{all.length ? 'No match.' : (absent ?? 'No run has any yet.')}</p>}
      </Picks>
      {value.length > 0 && (
        <Button small onClick={() => onChange(undefined)}>Any {name.toLowerCase()}</Button>
      )}
    </Menu>
  )
}
