// The text of a method with its settings: the installed one on help pages, the stored one on a run's page.
import { Fragment } from 'react'
import { boundsOf, optionsOf, type Schema, statedBy } from '../api/schema'
import type { MethodEntry } from '../client'
import { count } from '../format/numbers'
import { type Column, Table } from '../ui/Table'
import { Docstring } from './Docstring'
import styles from './help.module.css'

export function MethodText({ method }: { method: MethodEntry }) {
  const options = Object.entries(optionsOf(method))
  const { suits, drawback, family, parallel, starts } = method
  const facts = { For: suits, Drawback: drawback, Family: family, 'Points at a time': parallel, Starts: starts && 'from points given in the campaign' }
  return (
    <>
      <Docstring text={method.text} />
      <dl className={styles.guarantee}>
        <dt className="mut">In a campaign</dt>
        <dd className="mono">{method.name}</dd>
        <dt className="mut">Source</dt>
        <dd>{method.source}</dd>
        <dt className="mut">Default budget</dt>
        <dd>
          {count(method.evaluations)} evaluations{endsOf(method)}
        </dd>
        {Object.entries(facts).map(([title, text]) => text && (
          <Fragment key={title}>
            <dt className="mut">{title}</dt>
            <dd>{text}</dd>
          </Fragment>
        ))}
      </dl>
      {options.length > 0 && (
        <details>
          <summary>{options.length === 1 ? 'One setting' : `${options.length} settings`}</summary>
          <Table tight rows={options} by={([name]) => name} columns={COLUMNS} />
        </details>
      )}
    </>
  )
}

const COLUMNS: readonly Column<[string, Schema]>[] = [
  { head: 'Setting', tone: 'mono', cell: ([name]) => name },
  { head: 'Default', tone: 'tn nw', cell: ([, rule]) => (rule.default === undefined ? 'must be given' : written(rule.default)) },
  { head: 'Meaning', tone: 'sec', cell: ([, rule]) => meaning(rule) },
]

const written = (value: unknown): string =>
  value === null ? 'none' : typeof value === 'string' || typeof value === 'number' ? String(value) : JSON.stringify(value)

const meaning = (rule: Schema): string =>
  [rule.description, boundsOf(rule) || statedBy(rule).enum?.map(written).join(', ')].filter(Boolean).join(' · ')

/** When a search ends: at its budget, by its own rule, or by a rule that an option sets. */
function endsOf({ whole_budget, own_rule, effort }: MethodEntry): string {
  if (!whole_budget) return ' at most; its own rule may end it earlier'
  return own_rule || effort ? ', used in full unless its options end it earlier' : ', always used in full'
}
