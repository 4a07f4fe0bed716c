// The compared runs with their letters; removes and adds runs.
import { Select } from '../overlay/fields'
import { IconPlus, IconX } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { clsx } from 'clsx'
import { type ReactNode, useState } from 'react'
import { listRuns } from '../api/calls'
import { RunLink } from '../ui/RunLink'
import type { Column } from '../ui/Table'
import { RunBadge } from '../ui/VerdictBadge'
import { type Compared, type Comparison, isDone } from './data'
import { MOST, withRun } from './search'
import { IconButton } from '../ui/IconButton'
import { cards, layout, tables } from '../ui/styles'
import styles from './compare.module.css'

interface PicksProps {
  comparison: Comparison
  ids: readonly string[]
  onChange: (ids: string[]) => void
}

export function Picks({ comparison, ids, onChange }: PicksProps) {
  const without = (id: string) => onChange(ids.filter((other) => other !== id))
  return (
    <div className={styles.cmpPicks}>
      {ids.map((id) => {
        const compared = comparison.runs.find((run) => run.id === id)
        if (compared) return <Pick key={id} compared={compared} onRemove={() => without(id)} />
        const missing = comparison.missing.find((run) => run.id === id)
        return <Unread key={id} id={id} error={missing?.error} onRemove={() => without(id)} />
      })}
      {ids.length < MOST && <Add ids={ids} onAdd={(id) => onChange(withRun(ids, id))} />}
    </div>
  )
}

/** A run that is still loaded, or that could not be: it has its place already, so that nothing moves when it comes. */
function Unread({ id, error, onRemove }: { id: string; error: Error | undefined; onRemove: () => void }) {
  return (
    <div className={clsx(cards.card, styles.cmpPick)} role={error ? 'alert' : undefined}>
      <span className={styles.letter}>{error ? '?' : '…'}</span>
      <div className={clsx(tables.rn, layout.grow, styles.who)}>
        <b className="mono">{id}</b>
        <small className={error ? 'bad-t' : undefined}>{error ? error.message : 'Loading …'}</small>
      </div>
      <Remove id={id} onRemove={onRemove} />
    </div>
  )
}

function Pick({ compared, onRemove }: { compared: Compared; onRemove: () => void }) {
  const { run, letter } = compared
  return (
    <div className={clsx(cards.card, styles.cmpPick)} data-run={run.id}>
      <Letter of={letter} />
      <div className={clsx(tables.rn, layout.grow, styles.who)}>
        <RunLink run={run.id} className="b" title={run.name}>{run.name}</RunLink>
        <small>
          <span className="mono">{run.id}</span> · {run.campaign_name}
        </small>
      </div>
      <RunBadge run={run} />
      <Remove id={run.id} onRemove={onRemove} />
    </div>
  )
}

export const Letter = ({ of }: { of: string }) => <span className={clsx(styles.letter, styles[`letter${of}`])}>{of}</span>

/** A column for each run. */
export const runColumns = <T,>(
  runs: readonly Compared[],
  cell: (row: T, run: number) => ReactNode,
  tone?: (row: T, run: number) => string | false | undefined,
): Column<T>[] =>
  runs.map(({ letter }, k) => ({ head: <Letter of={letter} />, num: true, tone: (row) => tone?.(row, k), cell: (row) => cell(row, k) }))

/** The same of what a search found: of a run that is not done, only what it has found so far. */
export const foundColumns = <T,>(runs: readonly Compared[], ...cells: Tail<Parameters<typeof runColumns<T>>>): Column<T>[] =>
  runColumns<T>(runs, ...cells).map((column, k) => (isDone(runs[k]) ? column : { ...column, head: <>{column.head} <span className="mut small">so far</span></> }))

type Tail<All extends unknown[]> = All extends [unknown, ...infer Rest] ? Rest : never

/** The column of the difference of two runs. */
export const apartColumn = <T,>(cell: (row: T) => ReactNode): Column<T> => ({ head: 'B minus A', num: true, tone: 'b', cell })

function Remove({ id, onRemove }: { id: string; onRemove: () => void }) {
  return <IconButton bare label={`Take ${id} out`} icon={IconX} act={onRemove} />
}

function Add({ ids, onAdd }: { ids: readonly string[]; onAdd: (id: string) => void }) {
  const [text, setText] = useState('')
  const found = useQuery({
    queryKey: ['runs to compare', text],
    queryFn: () => listRuns({ q: text.replace(/ · .*/, '') }, null, 20),
    placeholderData: (before) => before,
  }).data
  const options = (found?.items ?? [])
    .filter((run) => !ids.includes(run.id))
    .map((run) => ({ value: run.id, label: `${run.id} · ${run.name}` }))
  return (
    <Select
      className={styles.cmpPickAdd}
      aria-label="Add a run to compare"
      placeholder={ids.length === 0 ? 'Choose the first run' : ids.length === 1 ? 'Choose the second run' : 'Add a run'}
      leftSection={<IconPlus className="i s" aria-hidden />}
      data={options}
      value={null}
      searchable
      searchValue={text}
      onSearchChange={setText}
      // The service has already filtered the options.
      filter={({ options: all }) => all}
      nothingFoundMessage="No run matches"
      onChange={(id) => {
        if (!id) return
        onAdd(id)
        setText('')
      }}
    />
  )
}
