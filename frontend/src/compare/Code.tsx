// The code version of each run: digests, packages, machine, and a warning if one campaign ran with different code.
import { clsx } from 'clsx'
import { Card } from '../ui/Card'
import { Digest } from '../ui/Digests'
import { Table } from '../ui/Table'
import { changedFiles, type CodeRow, codeRows, otherCode } from './code'
import { OtherCode } from './OtherCode'
import type { Compared } from './data'
import { runColumns } from './Picks'
import { unreadOf } from '../trends/code'
import { cards, figures, layout } from '../ui/styles'
import styles from './compare.module.css'

export function Code({ runs }: { runs: Compared[] }) {
  const details = runs.map(({ run }) => run)
  const changed = changedFiles(details)
  const missing = runs.filter(({ run }) => !run.identity?.digest)
  return (
    <Card title="Code and packages" note="As loaded at the start of the first stage" className={layout.c12} flush id="code">
      <OtherCode runs={details} className={clsx(cards.note, cards.warn, styles.within)} more=" This alone may change the results. Rows that differ are marked." />
      {changed.length > 0 && otherCode(details) === null && (
        <p className={figures.fig} data-testid="changed-files">
          Changed between these runs: {changed.join(', ')}.
        </p>
      )}
      <Table
        tight
        className={styles.codes}
        rows={codeRows(details)}
        row={({ key }) => ({ 'data-code': key })}
        columns={[
          { head: '', tone: 'nw', cell: ({ name }) => name },
          ...runColumns<CodeRow>(
            runs,
            ({ values, digest }, k) => <Value value={values[k]} digest={digest} />,
            ({ values, differs }, k) => differs && values[k] !== undefined && values[k] !== values[0] && styles.other,
          ),
        ]}
      />
      {missing.length > 0 && (
        <p className={figures.fig}>
          {missing.map(({ letter, run }) => `${letter}: ${unreadOf(run.identity)}`).join('; ')}. A difference cannot be excluded.
        </p>
      )}
    </Card>
  )
}

function Value({ value, digest }: { value: string | undefined; digest: boolean | undefined }) {
  if (value === undefined) return <span className="mut">not stored</span>
  return digest ? <Digest of={value} first={12} /> : <span title={value}>{value}</span>
}
