// Differences between the campaigns by setting; all settings on request.
import { clsx } from 'clsx'
import { exact } from '../format/numbers'
import { unitText } from '../format/units'
import { Card, Seg } from '../ui/Card'
import type { Compared } from './data'
import type { Row, Setting } from './differences'
import { Letter } from './Picks'
import { tables } from '../ui/styles'
import styles from './compare.module.css'

interface DefinitionProps {
  runs: Compared[]
  rows: Row[]
  all: boolean
  onAll: (all: boolean) => void
}

export function Definition({ runs, rows, all, onAll }: DefinitionProps) {
  const differing = rows.filter((row) => row.differs)
  const shown = all ? rows : differing
  const groups = [...new Set(shown.map((row) => row.group))]
  return (
    <Card
      title="What differs in the definition"
      note={`${differing.length} of ${rows.length} settings; ${differing.length < rows.length ? 'all others are equal' : 'no setting is equal'}`}
      flush={shown.length > 0}
      id="definition"
      right={
        <Seg
          label="Settings shown"
          options={{ differing: 'Only what differs', all: 'All' }}
          value={all ? 'all' : 'differing'}
          onChange={(value) => onAll(value === 'all')}
        />
      }
    >
      {shown.length === 0 ? (
        <p className="sec">The campaigns are equal in every setting: differences in the results have other causes.</p>
      ) : (
        <div className={styles.settings} tabIndex={0} role="region" aria-label="Settings">
          <table className={clsx(tables.table, tables.tight)}>
            <thead>
              <tr>
                <th>Setting</th>
                {runs.map(({ letter }) => (
                  <th key={letter} className="num">
                    <Letter of={letter} />
                  </th>
                ))}
              </tr>
            </thead>
            {groups.map((group) => (
              <tbody key={group}>
                <tr className={styles.group}>
                  <th className="b sec" colSpan={runs.length + 1} scope="rowgroup">
                    {group}
                  </th>
                </tr>
                {shown
                  .filter((row) => row.group === group)
                  .map((row) => (
                    <SettingRow key={row.path} row={row} />
                  ))}
              </tbody>
            ))}
          </table>
        </div>
      )}
    </Card>
  )
}

function SettingRow({ row }: { row: Row }) {
  return (
    <tr data-setting={row.path}>
      <td>
        <span className="mono">{row.path}</span>
        {row.text && <small className={clsx('mut', styles.wrap)}> {row.text}</small>}
      </td>
      {row.values.map((value, i) => (
        <td key={i} className={row.differs && value !== row.values[0] ? clsx('num', styles.other) : 'num'}>
          {shownAs(value)}
          {typeof value === 'number' && row.unit && <span className="mut small"> {unitText(row.unit)}</span>}
        </td>
      ))}
    </tr>
  )
}

function shownAs(value: Setting | undefined) {
  if (value === undefined) return <span className="mut">not present</span>
  if (value === null) return <span className="mut">none</span>
  if (typeof value === 'number') return exact(value)
  if (typeof value === 'boolean') return value ? 'yes' : 'no'
  return value
}
