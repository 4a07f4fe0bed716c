// Labelled fields of a campaign, and the button that removes an entry of a list: each with its problems next to it.
import type { SelectProps } from '@mantine/core'
import { IconTrash } from '@tabler/icons-react'
import type { ReactNode } from 'react'
import { Select } from '../../overlay/fields'
import { IconButton } from '../../ui/IconButton'
import { NumberCell, type NumberCellProps } from './NumberCell'
import { FieldErrors, idOf } from './problems'
import { fields } from '../../ui/styles'

interface LabelledProps {
  field: string
  label: ReactNode
  unit?: string
  /** What it means, below it. */
  text?: ReactNode
  /** The field whose problems are shown, with those of everything below it, instead of its own alone. */
  within?: string
  children: ReactNode
}

export function Labelled({ field, label, unit, text, within, children }: LabelledProps) {
  return (
    <div>
      <label className={fields.lbl} htmlFor={idOf(field)}>
        {label}
        {unit && <span className="mut">, {unit}</span>}
      </label>
      {children}
      {text && <small>{text}</small>}
      <FieldErrors field={within ?? field} deep={within !== undefined} />
    </div>
  )
}

interface NumberFieldProps extends NumberCellProps, Pick<LabelledProps, 'unit' | 'text' | 'within'> {
  /** The visible label, if it differs from the name. */
  title?: ReactNode
}

export function NumberField({ title, unit, text, within, ...cell }: NumberFieldProps) {
  return (
    <Labelled field={cell.field} label={title ?? cell.label} unit={unit} text={text} within={within}>
      <NumberCell {...cell} />
    </Labelled>
  )
}

interface ChoiceProps extends Omit<SelectProps, 'onChange' | 'id'> {
  field?: string
  onChange: (value: string) => void
}

/** One of several values, never none. */
export function Choice({ field, onChange, ...select }: ChoiceProps) {
  return (
    <Select
      id={field && idOf(field)}
      labelProps={{ className: fields.lbl }}
      size="xs"
      allowDeselect={false}
      onChange={(value) => value !== null && onChange(value)}
      {...select}
    />
  )
}

/** Chooses what is added to a list; `key` it by the length of the list, so that it is empty afterwards. */
export function Adder({ what, wide, position, ...choice }: ChoiceProps & { what: string; wide: number; position: 'bottom-start' | 'bottom-end' }) {
  return (
    <Choice
      aria-label={`Add ${what}`}
      placeholder={`Add ${what}`}
      nothingFoundMessage={`No such ${what}`}
      value={null}
      searchable
      w={190}
      comboboxProps={{ width: wide, position }}
      {...choice}
    />
  )
}

export const RemoveButton = ({ label, onClick }: { label: string; onClick: () => void }) => (
  <IconButton bare label={label} title="Remove" icon={IconTrash} act={onClick} />
)
