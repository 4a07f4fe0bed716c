// A table with a row for each item: a column has its header, and what each cell of it has.
import { clsx } from 'clsx'
import type { ReactNode } from 'react'
import tables from './tables.module.css'

export interface Column<T> {
  head: ReactNode
  /** The class of the header and of the cells, such as `num`. */
  align?: string
  /** Further classes of the cells. */
  look?: string
  /** The label of a cell where the cells are below each other; that of the header is left out there. */
  label?: string | ((item: T) => string | undefined)
  title?: (item: T) => string | undefined
  cell: (item: T) => ReactNode
}

interface DataTableProps<T> {
  items: readonly T[]
  keyOf: (item: T) => string | number
  columns: readonly Column<T>[]
  /** Cells below each other in narrow windows, or rows with less air. */
  kind: 'stack' | 'tight'
  label?: string
}

export function DataTable<T>({ items, keyOf, columns, kind, label: name }: DataTableProps<T>) {
  return (
    <table className={clsx(tables.table, kind === 'stack' ? tables.stack : tables.tight)} aria-label={name}>
      <thead>
        <tr>
          {columns.map(({ head, align }, i) => (
            <th key={i} className={align}>
              {head}
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        {items.map((item) => (
          <tr key={keyOf(item)}>
            {columns.map(({ align, look, label, title, cell }, i) => (
              <td key={i} className={clsx(align, look) || undefined} data-label={typeof label === 'function' ? label(item) : label} title={title?.(item)}>
                {cell(item)}
              </td>
            ))}
          </tr>
        ))}
      </tbody>
    </table>
  )
}

/** The header of a column of buttons, for screen readers alone. */
export const hidden = (name: string): ReactNode => <span className="sr">{name}</span>
