// The uncertain parameters: selection, bounds, distributions.
import { clsx } from 'clsx'
import { useState } from 'react'
import type { Uncertain } from '../../api/campaign'
import { Card } from '../../ui/Card'
import { Correlations } from './Correlations'
import { numberOf, type Parameter } from '../campaign/parameters'
import { Adder } from '../fields/Field'
import { FieldErrors } from '../fields/problems'
import type { FormProps } from '../fields/props'
import { UncertainRow } from './UncertainRow'
import { layout, tables } from '../../ui/styles'
import styles from './form.module.css'

export function UncertainTable(form: FormProps) {
  const { campaign, parameters, set } = form
  // Deselected parameters keep their bounds on the page, so that they can be restored.
  const [fixed, setFixed] = useState<Record<string, Uncertain>>({})
  const uncertain = campaign.uncertain
  const known = new Map(parameters.map((parameter) => [parameter.path, parameter]))
  const order = new Map(parameters.map((parameter, i) => [parameter.path, i]))
  const rows = [...new Set([...Object.keys(uncertain), ...Object.keys(fixed)])].sort(
    (a, b) => (order.get(a) ?? 1e9) - (order.get(b) ?? 1e9),
  )
  const toggle = (path: string, on: boolean) => {
    if (on) set(['uncertain', path], fixed[path] ?? startingBounds(known.get(path)))
    else {
      setFixed({ ...fixed, [path]: uncertain[path] ?? {} })
      set(['uncertain', path], undefined)
    }
  }
  const vary = Object.keys(uncertain).length
  // Parameters of several parts may have the same text: their controls are distinguished by the part.
  const texts = rows.map((path) => known.get(path)?.entry.text)
  const nameOf = (path: string) => {
    const parameter = known.get(path)
    if (!parameter) return path
    const { text } = parameter.entry
    return texts.indexOf(text) === texts.lastIndexOf(text) ? text : `${text}, ${parameter.group}`
  }
  const free = parameters.filter((parameter) => !rows.includes(parameter.path))
  return (
    <Card
      title="Uncertain parameters"
      note={`${vary} of ${rows.length} vary. Untick to hold a parameter at its nominal value.`}
      id="section-uncertain"
      flush
      right={<AddParameter free={free} onAdd={(path) => toggle(path, true)} />}
      footer={
        'The search uses only the bounds. The distribution applies to the independent sample, so its statistical bound ' +
        'holds for that distribution.'
      }
    >
      <table data-dense className={clsx(tables.table, tables.tight, styles.ptable, styles.inTable)}>
        <thead>
          <tr>
            <th aria-label="Varies" />
            <th>Symbol</th>
            <th>Parameter</th>
            <th className="num">Nominal</th>
            <th className="num">Low</th>
            <th className="num">High</th>
            <th>Unit</th>
            <th>Distribution</th>
            <th className={layout.hideN}>Density over bounds</th>
          </tr>
        </thead>
        <tbody>
          {rows.map((path) => (
            <UncertainRow
              key={path}
              path={path}
              name={nameOf(path)}
              parameter={known.get(path)}
              uncertain={uncertain[path]}
              fixed={fixed[path]}
              onToggle={(on) => toggle(path, on)}
              set={set}
            />
          ))}
        </tbody>
      </table>
      <div id="f-uncertain" tabIndex={-1} style={{ padding: '0 16px 8px' }}>
        <FieldErrors field="uncertain" />
        <Correlations {...form} />
      </div>
    </Card>
  )
}

/** Twenty percent around the nominal value; for a nominal value of zero the bounds must be given. */
function startingBounds(parameter: Parameter | undefined): Uncertain {
  const nominal = numberOf(parameter?.nominal)
  return nominal ? { plus_minus: '20%' } : { low: '', high: '' }
}

function AddParameter({ free, onAdd }: { free: Parameter[]; onAdd: (path: string) => void }) {
  const groups = [...new Set(free.map((parameter) => parameter.group))]
  const data = groups.map((group) => ({
    group,
    items: free
      .filter((parameter) => parameter.group === group)
      .map((parameter) => ({ value: parameter.path, label: `${parameter.entry.text} (${parameter.path})` })),
  }))
  return <Adder key={free.length} what="parameter" wide={360} position="bottom-end" data={data} maxDropdownHeight={360} onChange={onAdd} />
}
