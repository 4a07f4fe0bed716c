// Selects the columns of the list. Their order is fixed; the run column is always shown.
import { IconAdjustmentsHorizontal } from '@tabler/icons-react'
import { type Column, COLUMNS, columnsOf } from './columns'
import { Button } from '../ui/Button'
import { Menu, Pick, Picks } from '../overlay/Menu'

interface ColumnsMenuProps {
  cols: string[] | undefined
  /** Whether the list shows removed runs. */
  removed: boolean
  onChange: (cols: string[] | undefined) => void
}

export function ColumnsMenu({ cols, removed, onChange }: ColumnsMenuProps) {
  const shown = columnsOf(cols, removed)
  const toggle = (toggled: Column, on: boolean) =>
    onChange(COLUMNS.filter((column) => (column === toggled ? on : shown.includes(column))).map(({ key }) => key))
  return (
    <Menu name="Columns" value={null} on={cols !== undefined} icon={<IconAdjustmentsHorizontal className="i" aria-hidden />}>
      <Picks label="Columns">
        {COLUMNS.map((column) => (
          <Pick key={column.key} on={shown.includes(column)} onChange={(on) => toggle(column, on)}>
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
