// A number as text: not reformatted while typing; invalid text is kept, so that the service reports it.
import { useState } from 'react'
import type { Raw } from '../../api/campaign'
import { parse, field as shown } from '../../format/numbers'
import { idOf, useProblems } from './problems'
import fields from '../../ui/fields.module.css'

export interface NumberCellProps {
  /** The service's name of the field. */
  field: string
  label: string
  value: Raw | null | undefined
  onChange: (value: Raw | null) => void
  disabled?: boolean
  /** Empty if not given. */
  optional?: boolean
  placeholder?: string
  invalid?: boolean
}

const textOf = (value: Raw | null | undefined): string =>
  value === null || value === undefined ? '' : typeof value === 'number' ? shown(value) : value

export function NumberCell({
  field,
  label,
  value,
  onChange,
  disabled,
  optional,
  placeholder,
  invalid,
}: NumberCellProps) {
  const [typed, setTyped] = useState<string | null>(null)
  const problems = useProblems(field)
  const meaning = (text: string): Raw | null => (optional && text.trim() === '' ? null : (parse(text) ?? text))
  // Typed text is unchanged while it represents the value; a value set elsewhere replaces it.
  const text = typed !== null && meaning(typed) === (value ?? null) ? typed : textOf(value)
  const change = (next: string) => {
    setTyped(next)
    onChange(meaning(next))
  }
  return (
    <input
      id={idOf(field)}
      className={fields.cell}
      inputMode="decimal"
      autoComplete="off"
      spellCheck={false}
      aria-label={label}
      aria-invalid={invalid || problems.length > 0}
      title={problems[0]?.message}
      placeholder={placeholder}
      disabled={disabled}
      value={text}
      onChange={(event) => change(event.target.value)}
    />
  )
}
