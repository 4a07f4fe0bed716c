// Numbers as text, one or several: not reformatted while typing; invalid text is kept, so that the service reports it.
import { type InputHTMLAttributes, useState } from 'react'
import type { Raw } from '../../api/campaign'
import { parse, field as shown } from '../../format/numbers'
import { idOf, useProblems } from './problems'
import { fields } from '../../ui/styles'

type Value = Raw | null | undefined

interface TypedCellProps<T> extends Pick<InputHTMLAttributes<HTMLInputElement>, 'inputMode' | 'disabled' | 'placeholder'> {
  /** The service's name of the field. */
  field: string
  label: string
  value: T
  textOf: (value: T) => string
  meaningOf: (text: string) => T
  onChange: (value: T) => void
  invalid?: boolean
  /** Whether the problems of everything below the field count. */
  deep?: boolean
}

function TypedCell<T>({ field, label, value, textOf, meaningOf, onChange, invalid, deep, ...input }: TypedCellProps<T>) {
  const [typed, setTyped] = useState<string | null>(null)
  const problems = useProblems(field, deep)
  // Typed text is unchanged while it represents the value; a value set elsewhere replaces it.
  const same = typed !== null && JSON.stringify(meaningOf(typed)) === JSON.stringify(value)
  return (
    <input
      id={idOf(field)}
      className={fields.cell}
      autoComplete="off"
      spellCheck={false}
      aria-label={label}
      aria-invalid={invalid || problems.length > 0}
      title={problems[0]?.message}
      value={same ? typed : textOf(value)}
      onChange={({ target }) => {
        setTyped(target.value)
        onChange(meaningOf(target.value))
      }}
      {...input}
    />
  )
}

export interface NumberCellProps extends Pick<TypedCellProps<unknown>, 'field' | 'label' | 'disabled' | 'placeholder' | 'invalid'> {
  value: Value
  onChange: (value: Raw | null) => void
  /** Empty if not given. */
  optional?: boolean
}

const textOf = (value: Value): string => (typeof value === 'number' ? shown(value) : (value ?? ''))

export function NumberCell({ value = null, optional, ...cell }: NumberCellProps) {
  const meaningOf = (text: string) => (optional && text.trim() === '' ? null : (parse(text) ?? text))
  return <TypedCell<Raw | null> value={value} textOf={textOf} meaningOf={meaningOf} inputMode="decimal" {...cell} />
}

interface ListCellProps extends Pick<TypedCellProps<Raw[]>, 'field' | 'label' | 'onChange'> {
  values: Raw[]
}

export const listText = (values: readonly Raw[]): string => values.map(textOf).join(', ')

export const listOf = (text: string): Raw[] =>
  text
    .split(/[,;\s]+/)
    .filter(Boolean)
    .map((word) => parse(word) ?? word)

/** Several whole numbers, separated by commas. */
export const ListCell = ({ values, ...cell }: ListCellProps) => (
  <TypedCell value={values} textOf={listText} meaningOf={listOf} deep {...cell} />
)
