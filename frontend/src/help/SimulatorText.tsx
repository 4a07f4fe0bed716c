// The text of a simulator with its parameters and results, from the catalogue.
import { clsx } from 'clsx'
import type { SimulatorEntry } from '../client'
import { unitText } from '../format/units'
import { Sign } from '../ui/Sign'
import { Parameters } from './ComponentText'
import { Docstring } from './Docstring'
import tables from '../ui/tables.module.css'

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
        <table className={clsx(tables.table, tables.tight)}>
          <thead>
            <tr>
              <th>Name</th>
              <th>Symbol</th>
              <th>Meaning</th>
              <th>Worse when</th>
              <th>Unit</th>
            </tr>
          </thead>
          <tbody>
            {results.map((result) => (
              <tr key={result.name}>
                <td className="mono">{result.name}</td>
                <td>
                  <Sign text={result.quantity} />
                </td>
                <td className="sec">{result.text || result.title}</td>
                <td className="sec">{result.worse}</td>
                <td className="sec">{unitText(result.unit)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </details>
    </>
  )
}
