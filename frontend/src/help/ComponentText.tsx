// The text of a component with its parameters: the installed one on help pages, the stored one on a run's page.
import { clsx } from 'clsx'
import type { ComponentEntry, ParameterEntry } from '../client'
import { plain } from '../format/numbers'
import { unitText } from '../format/units'
import { Sign } from '../ui/Sign'
import { Docstring } from './Docstring'
import tables from '../ui/tables.module.css'

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

export function Parameters({ entries }: { entries: readonly ParameterEntry[] }) {
  return (
    <table className={clsx(tables.table, tables.tight)}>
      <thead>
        <tr>
          <th>Name</th>
          <th>Symbol</th>
          <th>Meaning</th>
          <th className="num">Default</th>
          <th className="num">Allowed</th>
          <th>Unit</th>
        </tr>
      </thead>
      <tbody>
        {entries.map((entry) => (
          <tr key={entry.name}>
            <td className="mono">{entry.name}</td>
            <td>
              <Sign text={entry.symbol} />
            </td>
            <td className="sec">{entry.text}</td>
            <td className="num">{entry.default === null ? 'must be given' : plain(entry.default)}</td>
            <td className="num sec">
              {plain(entry.low)} to {plain(entry.high)}
            </td>
            <td className="sec">{unitText(entry.unit)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  )
}
