// The text of a simulator with its parameters and results, from the catalogue.
import type { ResultEntry, SimulatorEntry } from '../client'
import { unitText } from '../format/units'
import { type Column, DataTable } from '../ui/DataTable'
import { Sign } from '../ui/Sign'
import { Parameters } from './ComponentText'
import { Docstring } from './Docstring'

const COLUMNS: readonly Column<ResultEntry>[] = [
  { head: 'Name', look: 'mono', cell: ({ name }) => name },
  { head: 'Symbol', cell: ({ quantity }) => <Sign text={quantity} /> },
  { head: 'Meaning', look: 'sec', cell: ({ text, title }) => text || title },
  { head: 'Worse when', look: 'sec', cell: ({ worse }) => worse },
  { head: 'Unit', look: 'sec', cell: ({ unit }) => unitText(unit) },
]

export function SimulatorText({ simulator }: { simulator: SimulatorEntry }) {
  const { text, parameters, results } = simulator
  return (
    <>
      <Docstring text={text} />
      {parameters.length > 0 && (
        <details>
          <summary>Parameters: {parameters.length}</summary>
          <Parameters entries={parameters} />
        </details>
      )}
      <details>
        <summary>Results: {results.length}</summary>
        <DataTable kind="tight" items={results} keyOf={({ name }) => name} columns={COLUMNS} />
      </details>
    </>
  )
}
