// The text of a simulator with its parameters and results, from the catalogue.
import type { ResultEntry, SimulatorEntry } from '../client'
import { unitText } from '../format/units'
import type { Column } from '../ui/Table'
import { Sign } from '../ui/Sign'
import { Listed, PARAMETERS } from './ComponentText'
import { Docstring } from './Docstring'

const COLUMNS: readonly Column<ResultEntry>[] = [
  { head: 'Name', tone: 'mono', cell: ({ name }) => name },
  { head: 'Symbol', cell: ({ quantity }) => <Sign text={quantity} /> },
  { head: 'Meaning', tone: 'sec', cell: ({ text, title }) => text || title },
  { head: 'Worse when', tone: 'sec', cell: ({ worse }) => worse },
  { head: 'Unit', tone: 'sec', cell: ({ unit }) => unitText(unit) },
]

export function SimulatorText({ simulator }: { simulator: SimulatorEntry }) {
  const { text, parameters, results } = simulator
  return (
    <>
      <Docstring text={text} />
      <Listed title="Parameters" rows={parameters} columns={PARAMETERS} />
      <Listed title="Results" rows={results} columns={COLUMNS} />
    </>
  )
}
