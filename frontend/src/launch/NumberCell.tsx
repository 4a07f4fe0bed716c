// A number as text: nothing is rounded or reformatted while it is typed; what is no number is kept for the service to name.
import { useEffect, useState } from 'react'
import type { Raw } from '../api/campaign'
import { parse, field as shown } from '../format/numbers'
import { idOf, useProblems } from './problems'

interface NumberCellProps {
  /** The service's name of the field. */
  field: string
  label: string
  value: Raw | null | undefined
  onChange: (value: Raw | null) => void
  disabled?: boolean
  /** Empty means that it is not given. */
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
  const [text, setText] = useState(textOf(value))
  const problems = useProblems(field)
  // A value set from elsewhere replaces the text; one that means the same as what is being typed does not.
  useEffect(() => {
    setText((typed) =>
      value === typed || (typeof value === 'number' && parse(typed) === value) ? typed : textOf(value),
    )
  }, [value])
  const change = (typed: string) => {
    setText(typed)
    onChange(optional && typed.trim() === '' ? null : (parse(typed) ?? typed))
  }
  return (
    <input
      id={idOf(field)}
      className="cell"
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
