// Several numbers as comma-separated text; invalid entries are kept, so that the service reports them.
import { useState } from 'react'
import type { Raw } from '../../api/campaign'
import { parse, field as shown } from '../../format/numbers'
import { idOf, useProblems } from './problems'
import fields from '../../ui/fields.module.css'

interface ListCellProps {
  field: string
  label: string
  values: readonly Raw[]
  onChange: (values: Raw[]) => void
}

export const listText = (values: readonly Raw[]): string =>
  values.map((value) => (typeof value === 'number' ? shown(value) : value)).join(', ')

export const listOf = (text: string): Raw[] =>
  text
    .split(/[,;\s]+/)
    .filter(Boolean)
    .map((word) => parse(word) ?? word)

export function ListCell({ field, label, values, onChange }: ListCellProps) {
  const [typed, setTyped] = useState<string | null>(null)
  const problems = useProblems(field, true)
  // As for single numbers: typed text is unchanged while it represents the values.
  const same = typed !== null && JSON.stringify(listOf(typed)) === JSON.stringify(values)
  return (
    <input
      id={idOf(field)}
      className={fields.cell}
      autoComplete="off"
      spellCheck={false}
      aria-label={label}
      aria-invalid={problems.length > 0}
      value={same ? typed : listText(values)}
      onChange={(event) => {
        setTyped(event.target.value)
        onChange(listOf(event.target.value))
      }}
    />
  )
}
