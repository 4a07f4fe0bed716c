// The text of a component with its parameters: the installed one on help pages, the stored one on a run's page.
import type { ComponentEntry, ParameterEntry } from '../client'
import { plain } from '../format/numbers'
import { unitText } from '../format/units'
import { type Column, Table } from '../ui/Table'
import { Sign } from '../ui/Sign'
import { Docstring } from './Docstring'

export function ComponentText({ component, open }: { component: ComponentEntry; open?: boolean }) {
  const groups = [
    { title: 'Parameters', entries: component.parameters },
    { title: 'Start states', entries: component.starts },
    { title: 'Goal', entries: component.goals },
  ].filter((group) => group.entries.length > 0)
  return (
    <>
      <Docstring text={component.text} />
      {groups.map((group) => (
        <details key={group.title} open={open}>
          <summary>
            {group.title}: {group.entries.length}
          </summary>
          <Parameters entries={group.entries} />
        </details>
      ))}
    </>
  )
}

const COLUMNS: readonly Column<ParameterEntry>[] = [
  { head: 'Name', tone: 'mono', cell: ({ name }) => name },
  { head: 'Symbol', cell: ({ symbol }) => <Sign text={symbol} /> },
  { head: 'Meaning', tone: 'sec', cell: ({ text }) => text },
  { head: 'Default', num: true, cell: (entry) => (entry.default === null ? 'must be given' : plain(entry.default)) },
  { head: 'Allowed', num: true, tone: 'sec', cell: ({ low, high }) => `${plain(low)} to ${plain(high)}` },
  { head: 'Unit', tone: 'sec', cell: ({ unit }) => unitText(unit) },
]

export const Parameters = ({ entries }: { entries: readonly ParameterEntry[] }) => (
  <Table tight rows={entries} by={({ name }) => name} columns={COLUMNS} />
)
