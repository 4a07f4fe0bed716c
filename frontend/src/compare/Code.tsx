// The code version of each run: digests, packages, machine, and a warning if one campaign ran with different code.
import { clsx } from 'clsx'
import { Card } from '../ui/Card'
import { changedComponents, codeRows, otherCode } from './code'
import { OtherCode } from './OtherCode'
import type { Compared } from './data'
import { RunHeads } from './Picks'
import cards from '../ui/cards.module.css'
import figures from '../ui/figures.module.css'
import tables from '../ui/tables.module.css'
import styles from './compare.module.css'

export function Code({ runs, className }: { runs: Compared[]; className: string | undefined }) {
  const told = runs.map(({ run }) => run)
  const rows = codeRows(told)
  const changed = changedComponents(told)
  const missing = runs.filter(({ run }) => !run.flown?.code)
  return (
    <Card title="Code and packages" note="As loaded at the start of the first stage" className={className} flush id="code">
      <OtherCode runs={told} className={clsx(cards.note, cards.warn, styles.within)} more=" This alone may change the results. Rows that differ are marked." />
      {changed.length > 0 && otherCode(told) === null && (
        <p className={figures.fig} data-testid="changed-components">
          Changed between these runs: {changed.join(', ')}.
        </p>
      )}
      <table className={clsx(tables.table, tables.tight, styles.codes)}>
        <thead>
          <tr>
            <th />
            <RunHeads runs={runs} />
          </tr>
        </thead>
        <tbody>
          {rows.map(({ key, name, values, differs, digest }) => (
            <tr key={key} data-code={key}>
              <td className="nw">{name}</td>
              {values.map((value, i) => (
                <td key={i} className={differs && value !== undefined && value !== values[0] ? clsx('num', styles.other) : 'num'}>
                  {value === undefined ? (
                    <span className="mut">not stored</span>
                  ) : (
                    <span className={digest ? 'mono' : ''} title={value}>
                      {digest ? value.slice(0, 12) : value}
                    </span>
                  )}
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
      {missing.length > 0 && (
        <p className={figures.fig}>
          {missing.map(({ letter }) => letter).join(', ')}: the code was not stored at the start of the run, so it cannot be
          compared.
        </p>
      )}
    </Card>
  )
}
