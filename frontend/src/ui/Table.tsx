// A table from its columns: the header and the cells of a column are declared together. A column that is false is omitted.
import { clsx } from 'clsx'
import type { HTMLAttributes, ReactNode } from 'react'
import { moment } from '../format/time'
import { NumHead } from './Card'
import { tables } from './styles'

export interface Column<T> {
  head: ReactNode
  /** Of the header. */
  title?: string
  width?: number
  num?: boolean
  /** Second line of the header; such a column is numeric. */
  unit?: ReactNode
  /** Of header and cells. */
  className?: string
  /** Further classes of a cell. */
  tone?: string | ((row: T, i: number) => string | false | undefined)
  /** The tooltip of a cell. */
  tip?: (row: T) => string | undefined
  /** The header next to a cell where cells are below each other. */
  label?: string | ((row: T) => string | undefined)
  cell: (row: T, i: number) => ReactNode
}

export type Columns<T> = readonly (Column<T> | false)[]

type RowProps = HTMLAttributes<HTMLTableRowElement> & Readonly<Record<`data-${string}`, string | null | undefined>>

interface TableProps<T> {
  columns: Columns<T>
  rows: readonly T[]
  /** The key of a row whose cells have a state. */
  by?: (row: T) => string | number
  row?: (row: T, i: number) => RowProps
  className?: string
  /** For screen readers. */
  name?: string
  /** A row of another kind before the others. */
  first?: ReactNode
  tight?: boolean
  /** In narrow windows the cells of a row are below each other. */
  stack?: boolean
}

export function Table<T>({ columns, rows, by, row: rowProps, className, name, first, tight, stack }: TableProps<T>) {
  const shown = columns.filter((column) => column !== false)
  return (
    <table className={clsx(tables.table, tight && tables.tight, stack && tables.stack, className)} aria-label={name}>
      <thead>
        <tr>
          {shown.map((column, k) => (
            <Head key={k} column={column} />
          ))}
        </tr>
      </thead>
      <tbody>
        {first}
        {rows.map((row, i) => (
          <tr key={by?.(row) ?? i} {...rowProps?.(row, i)}>
            {shown.map((column, k) => (
              <Cell key={k} column={column} row={row} i={i} />
            ))}
          </tr>
        ))}
      </tbody>
    </table>
  )
}

const isNum = ({ num, unit }: Pick<Column<never>, 'num' | 'unit'>): boolean => num === true || unit !== undefined

function Head<T>({ column: { head, unit, title, width, className, num } }: { column: Column<T> }) {
  if (unit !== undefined) return <NumHead unit={unit} title={title} className={className}>{head}</NumHead>
  return (
    <th className={clsx(num && 'num', className) || undefined} title={title} style={width === undefined ? undefined : { width }}>
      {head}
    </th>
  )
}

function Cell<T>({ column, row, i }: { column: Column<T>; row: T; i: number }) {
  const { className, tone, tip, label, cell } = column
  const toned = typeof tone === 'function' ? tone(row, i) : tone
  return (
    <td className={clsx(isNum(column) && 'num', toned, className) || undefined} title={tip?.(row)} data-label={typeof label === 'function' ? label(row) : label}>
      {cell(row, i)}
    </td>
  )
}

/** A column of buttons; its header is for screen readers alone. */
export const buttonColumn = <T,>(words: string, cell: (row: T) => ReactNode, tone = 'num'): Column<T> => ({
  head: <span className="sr">{words}</span>,
  tone,
  cell,
})

/** A column of times, each of which is stated in full under the pointer. */
export const timeColumn = <T,>(head: string, timeOf: (row: T) => number | null, cell: (row: T) => ReactNode): Column<T> => {
  const tip = (row: T) => {
    const time = timeOf(row)
    return time === null ? undefined : moment(time)
  }
  return { head, label: head, tone: 'sec nw', tip, cell }
}
