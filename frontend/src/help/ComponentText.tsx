// The text of a component with its parameters: the installed one on help pages, the stored one on a run's page.
import type { ComponentEntry, ParameterEntry } from '../client'
import { plain } from '../format/numbers'
import { unitText } from '../format/units'
import { type Column, type Columns, Table } from '../ui/Table'
import { Sign } from '../ui/Sign'
import { Docstring } from './Docstring'

export function ComponentText({ component, open }: { component: ComponentEntry; open?: boolean }) {
  return (
    <>
      <Docstring text={component.text} />
      <Listed title="Parameters" rows={component.parameters} columns={PARAMETERS} open={open} />
      <Listed title="Start states" rows={component.starts} columns={PARAMETERS} open={open} />
      <Listed title="Goal" rows={component.goals} columns={PARAMETERS} open={open} />
    </>
  )
}

export const PARAMETERS: readonly Column<ParameterEntry>[] = [
  { head: 'Name', tone: 'mono', cell: ({ name }) => name },
  { head: 'Symbol', cell: ({ symbol }) => <Sign text={symbol} /> },
  { head: 'Meaning', tone: 'sec', cell: ({ text }) => text },
  { head: 'Default', num: true, cell: (entry) => (entry.default === null ? 'must be given' : plain(entry.default)) },
  { head: 'Allowed', num: true, tone: 'sec', cell: ({ low, high }) => `${plain(low)} to ${plain(high)}` },
  { head: 'Unit', tone: 'sec', cell: ({ unit }) => unitText(unit) },
]

interface ListedProps<T> {
  title: string
  rows: readonly T[]
  columns: Columns<T>
  open?: boolean
}

/** What belongs to an entry of the catalogue, folded; nothing if there is none. */
export function Listed<T extends { name: string }>({ title, rows, columns, open }: ListedProps<T>) {
  if (rows.length === 0) return null
  return (
    <details open={open}>
      <summary>
        {title}: {rows.length}
      </summary>
      <Table tight rows={rows} by={({ name }) => name} columns={columns} />
    </details>
  )
}
