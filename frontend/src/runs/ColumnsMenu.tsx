// Selects the columns of the list. Their order is fixed; the run column is always shown.
import { IconAdjustmentsHorizontal } from '@tabler/icons-react'
import { COLUMNS } from './columns'
import type { ColumnKey } from './columnKeys'
import { Button } from '../ui/Button'
import { Menu, Pick, Picks } from '../ui/Menu'

interface ColumnsMenuProps {
  cols: ColumnKey[] | undefined
  /** The default columns. */
  usual: readonly ColumnKey[]
  onChange: (cols: ColumnKey[] | undefined) => void
}

export function ColumnsMenu({ cols, usual, onChange }: ColumnsMenuProps) {
  const shown = cols ?? usual
  const toggle = (key: ColumnKey, on: boolean) =>
    onChange(COLUMNS.map((column) => column.key).filter((k) => (k === key ? on : shown.includes(k))))
  return (
    <Menu name="Columns" value={null} on={cols !== undefined} icon={<IconAdjustmentsHorizontal className="i" aria-hidden />}>
      <Picks label="Columns">
        {COLUMNS.map((column) => (
          <Pick key={column.key} on={shown.includes(column.key)} onChange={(on) => toggle(column.key, on)}>
            {column.name}
          </Pick>
        ))}
      </Picks>
      {cols && (
        <Button small onClick={() => onChange(undefined)}>Default columns</Button>
      )}
    </Menu>
  )
}
