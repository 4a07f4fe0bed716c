// The numbers behind a chart as a table and as a CSV file (RFC 4180), at full precision.

export type Value = string | number | null

export interface DataTable {
  /** Without extension; prefixed with the run's id. */
  name: string
  columns: string[]
  rows: Value[][]
}

/** Text that a spreadsheet would calculate is marked as text (OWASP, "CSV Injection"), as in campaigns/cells.py. */
const FORMULA = /^[=+\-@\t\r\n＝＋－＠]/

const quoted = (value: Value): string => {
  if (value === null) return ''
  const marked = typeof value === 'string' && FORMULA.test(value)
  const text = marked ? `'${value}` : String(value)
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text
}

export function toCsv(table: DataTable): string {
  return `${[table.columns, ...table.rows].map((row) => row.map(quoted).join(',')).join('\r\n')}\r\n`
}
