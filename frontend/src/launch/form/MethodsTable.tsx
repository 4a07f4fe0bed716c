// The search methods: selection, budgets, options.
import { clsx } from 'clsx'
import { IconAdjustments, IconChevronDown, IconChevronUp } from '@tabler/icons-react'
import { useState } from 'react'
import type { SearchStage } from '../../api/campaign'
import type { MethodEntry } from '../../client'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { IconButton } from '../../ui/IconButton'
import { MethodName } from '../../ui/MethodMark'
import { MethodOptions } from './MethodOptions'
import { NumberCell } from '../fields/NumberCell'
import { FieldErrors, idOf, useProblems } from '../fields/problems'
import type { FormProps } from '../fields/props'
import { fields, layout, tables } from '../../ui/styles'
import styles from './form.module.css'

export function MethodsTable({ campaign, catalogue, parameters, set }: FormProps) {
  const [dropped, setDropped] = useState<Record<string, SearchStage>>({})
  // The methods above the others. While those are shown nothing moves, so that a ticked row stays under the pointer.
  const [fixed, setFixed] = useState<readonly string[] | null>(null)
  const stages = campaign.stages.search
  // What was chosen once stays among the first, so that it can be chosen again.
  const [known, setKnown] = useState<readonly string[]>([])
  const fresh = stages.map((stage) => stage.method).filter((method) => !known.includes(method))
  if (fresh.length > 0) setKnown([...new Set([...known, ...fresh])])
  const single = (campaign.objectives ?? []).length === 0
  const unknown = stages.flatMap((stage, i) => (catalogue.methods.some((m) => m.name === stage.method) ? [] : [i]))
  const replace = (next: SearchStage[]) => set(['stages', 'search'], next)
  const drop = (at: number) => {
    const stage = stages[at]
    if (stage) setDropped({ ...dropped, [stage.method]: stage })
    replace(stages.filter((_, i) => i !== at))
  }
  const add = (method: MethodEntry) => {
    const order = new Map(catalogue.methods.map((m, i) => [m.name, i]))
    const stage = dropped[method.name] ?? { method: method.name, evaluations: method.evaluations, options: {}, starts: [] }
    const rank = (s: SearchStage) => order.get(s.method) ?? 0
    const before = stages.findIndex((s) => rank(s) > rank(stage))
    replace(before < 0 ? [...stages, stage] : stages.toSpliced(before, 0, stage))
  }
  const above = new Set(fixed ?? known)
  const [first, others] = [catalogue.methods.filter((m) => above.has(m.name)), catalogue.methods.filter((m) => !above.has(m.name))]
  const rows = (methods: readonly MethodEntry[]) =>
    methods.flatMap((method) => {
      const own = stages.flatMap((stage, i) => (stage.method === method.name ? [i] : []))
      const places: (number | null)[] = own.length > 0 ? own : [null]
      return places.map((at, i) => (
        <MethodRow
          // The same row whether it is chosen or not: it keeps the focus.
          key={`${method.name}-${i}`}
          at={at}
          stage={at === null ? dropped[method.name] : stages[at]}
          method={method}
          single={single}
          parameters={parameters}
          set={set}
          onToggle={() => (at === null ? add(method) : drop(at))}
        />
      ))
    })
  return (
    <Card
      title="Methods and budgets"
      id="section-methods"
      note="Each search ends by its own rule or at its budget."
      flush
      footer="Cleared requires methods of two families that agree on the worst case (Auto has both), and an independent sample."
    >
      <table data-dense className={clsx(tables.table, tables.tight, styles.ptable)}>
        <thead>
          <tr>
            <th aria-label="Runs" />
            <th>Method</th>
            <th className={layout.hideS}>How it searches</th>
            <th className={layout.hideN}>Source</th>
            <th className="num" style={{ width: 140 }}>
              Evaluations at most
            </th>
            <th aria-label="Options" style={{ width: 44 }} />
          </tr>
        </thead>
        <tbody>
          {rows(first)}
          {others.length > 0 && (
            <tr>
              <td colSpan={6}>
                <Button small icon={fixed ? IconChevronUp : IconChevronDown} aria-expanded={fixed !== null} onClick={() => setFixed(fixed ? null : known)}>
                  {fixed ? 'Fewer methods' : `More methods (${others.length})`}
                </Button>
              </td>
            </tr>
          )}
          {fixed && rows(others)}
        </tbody>
      </table>
      <div style={{ padding: '0 16px 8px' }} id={idOf('stages.search')} tabIndex={-1}>
        <FieldErrors field="stages.search" />
        {unknown.map((i) => (
          <FieldErrors key={i} field={`stages.search.${i}`} deep />
        ))}
      </div>
    </Card>
  )
}

interface MethodRowProps extends Pick<FormProps, 'parameters' | 'set'> {
  /** Its index among the campaign's searches; null if not selected. */
  at: number | null
  stage: SearchStage | undefined
  method: MethodEntry
  /** True if there is only one criterion. */
  single: boolean
  onToggle: () => void
}

const ALONE =
  'It searches for the Pareto front of several criteria, but there is only one: add further ones under Criterion, or search with a global method.'

function MethodRow({ at, stage, method, single, parameters, set, onToggle }: MethodRowProps) {
  const [open, setOpen] = useState(false)
  const on = at !== null
  const field = `stages.search.${at ?? 'none'}`
  const problems = useProblems(field, true)
  const inside = problems.some((p) => p.field.startsWith(`${field}.options`) || p.field.startsWith(`${field}.starts`))
  const alone = on && single && method.kind === 'multi'
  const expanded = on && (open || inside)
  return (
    <>
      <tr
        className={on ? (expanded || alone || problems.length ? styles.hasError : undefined) : styles.off}
        id={idOf(field)}
        tabIndex={-1}
      >
        <td style={{ width: 40 }}>
          <input className={fields.check} type="checkbox" checked={on} aria-label={`Run ${method.title}`} onChange={onToggle} />
        </td>
        <td>
          <MethodName method={method.name} title={method.title} />
        </td>
        <td className={clsx(layout.hideS, 'sec')}>{[method.how, method.drawback].filter(Boolean).join('. ')}</td>
        <td className={clsx(layout.hideN, 'mut')}>{method.source}</td>
        <td>
          <NumberCell
            field={`${field}.evaluations`}
            label={`${method.title}, evaluations at most`}
            value={stage?.evaluations ?? method.evaluations}
            disabled={!on}
            onChange={(value) => on && set(['stages', 'search', at, 'evaluations'], value ?? '')}
          />
        </td>
        <td>
          <IconButton bare large label={`Options of ${method.title}`} title="Options" icon={IconAdjustments} expanded={expanded} off={!on} act={() => setOpen(!open)} />
        </td>
      </tr>
      {on && (expanded || alone || problems.length > 0) && (
        <tr className={styles.errors}>
          <td />
          <td colSpan={5}>
            <FieldErrors field={field} />
            <FieldErrors field={`${field}.evaluations`} />
            <FieldErrors field={`${field}.method`} />
            {alone && <p className="small sec">{ALONE}</p>}
            {expanded && stage && (
              <MethodOptions
                field={field}
                at={['stages', 'search', at]}
                stage={stage}
                method={method}
                parameters={parameters}
                set={set}
              />
            )}
          </td>
        </tr>
      )}
    </>
  )
}
