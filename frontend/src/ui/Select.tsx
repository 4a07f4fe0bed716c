// A list to choose one of, with the browser's own menu.
import type { ReactNode } from 'react'
import { fields } from './styles'

interface SelectProps<T extends string | number> {
  label?: string
  value: T
  options: readonly { value: T; label: ReactNode; disabled?: boolean }[]
  onChange: (value: T) => void
  disabled?: boolean
}

export function Select<T extends string | number>({ label, value, options, onChange, disabled }: SelectProps<T>) {
  const chosen = (text: string) => options.find((option) => String(option.value) === text)
  return (
    <select
      className={fields.select}
      aria-label={label}
      value={value}
      disabled={disabled}
      onChange={({ target }) => onChange(chosen(target.value)?.value ?? value)}
    >
      {options.map((option) => (
        <option key={option.value} value={option.value} disabled={option.disabled}>
          {option.label}
        </option>
      ))}
    </select>
  )
}
