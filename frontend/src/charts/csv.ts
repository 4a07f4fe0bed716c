// The numbers behind a chart as a table and as a CSV file (RFC 4180), at full precision.

export type Value = string | number | null

export interface DataTable {
  /** Without extension; prefixed with the run's id. */
  name: string
  columns: string[]
  rows: Value[][]
}

const quoted = (value: Value): string => {
  if (value === null) return ''
  const text = String(value)
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text
}

export function toCsv(table: DataTable): string {
  return `${[table.columns, ...table.rows].map((row) => row.map(quoted).join(',')).join('\r\n')}\r\n`
}
