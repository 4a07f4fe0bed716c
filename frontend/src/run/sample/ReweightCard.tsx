// The independent sample under moved distributions: sliders, and the estimate by re-weighting. Nothing is simulated.
import { useDebouncedValue } from '@mantine/hooks'
import { useQuery } from '@tanstack/react-query'
import { IconAlertTriangle } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { type CSSProperties, type ReactNode, useMemo, useState } from 'react'
import { reweightedQuery } from '../../api/queries'
import type { Reweighted } from '../../client'
import { atLeast, atMost, confidenceText, count, decimalsFor, fixed, NONE, percent, plain, probability } from '../../format/numbers'
import { sentence } from '../../format/spans'
import { ofUnit, unitText } from '../../format/units'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { Sign } from '../../ui/Sign'
import { Spans } from '../../ui/Spans'
import { Table } from '../../ui/Table'
import { useNearOrPrint } from '../../ui/useNear'
import type { RunData } from '../data/data'
import { type Knob, keyOf, knobsOf, type Moved, requestOf } from './moved'
import { fields, layout } from '../../ui/styles'
import styles from './sample.module.css'

/** A request at most so often while a slider moves [ms]. */
const PAUSE = 120
const STEPS = 1000
const STATED = { uncertain: {} }

/** Height of the card, for the balance of the columns. */
export const heightOf = (data: RunData): number => 330 + 34 * knobsOf(data).length

export function ReweightCard({ data }: { data: RunData }) {
  const { run, campaign } = data
  const [moved, setMoved] = useState<Moved>({})
  const knobs = useMemo(() => knobsOf(data), [data])
  const [body] = useDebouncedValue(useMemo(() => requestOf(knobs, moved, campaign), [knobs, moved, campaign]), PAUSE)
  const [card, near] = useNearOrPrint<HTMLElement>()
  const stated = useQuery({ ...reweightedQuery(run.id, STATED), enabled: near })
  const under = useQuery({ ...reweightedQuery(run.id, body), enabled: near })
  const changed = Object.keys(moved).length > 0
  return (
    <Card
      title="Other distributions"
      note="The stored draws re-weighted, nothing is simulated"
      id="reweight"
      ref={card}
      right={
        <Button small disabled={!changed} onClick={() => setMoved({})}>
          Back to the stated ones
        </Button>
      }
      footer={<Said found={under.data} why={under.error?.message ?? null} />}
    >
      <Estimates run={run} stated={stated.data} moved={changed && !under.error ? under.data : undefined} />
      <div className={styles.knobs} aria-busy={under.isFetching}>
        {knobs.map((knob) => (
          <Slider
            key={keyOf(knob)}
            knob={knob}
            value={moved[keyOf(knob)] ?? knob.stated}
            onChange={(value) => setMoved((before) => withMoved(before, knob, value))}
          />
        ))}
      </div>
    </Card>
  )
}

/** Of a sample that no certify stage drew. */
export function NotReweighted() {
  return (
    <Card title="Other distributions" id="reweight">
      <p className="sec">Only the independent sample of a certify stage is re-weighted to other distributions. This run has none.</p>
    </Card>
  )
}

function withMoved(before: Moved, knob: Knob, value: number): Moved {
  const { [keyOf(knob)]: _, ...others } = before
  return value === knob.stated ? others : { ...others, [keyOf(knob)]: value }
}

/** The estimate or why there is none, as a sentence. */
export function Said({ found, why }: { found: Reweighted | undefined; why: string | null }) {
  if (why === null && !found) return <>Reading the sample …</>
  return (
    <span role="status">
      {(why !== null || found?.probability == null) && <IconAlertTriangle className="i s" aria-hidden />}{' '}
      {why ?? <Spans spans={sentence(found?.statement ?? [])} />}
    </span>
  )
}

interface EstimatesProps {
  run: Pick<RunData['run'], 'quantity' | 'unit'>
  stated: Reweighted | undefined
  moved: Reweighted | undefined
}

/** The estimates under the stated and under the moved distributions, side by side. */
export function Estimates({ run, stated, moved }: EstimatesProps) {
  const both = [stated, moved]
  const shares = (stated ?? moved)?.quantiles.map(({ share }) => share) ?? []
  const at = (of: Reweighted | undefined, share: number) => of?.quantiles.find((one) => one.share === share)?.value
  const decimals = decimalsFor(both.flatMap((of) => of?.quantiles.map(({ value }) => value) ?? []), 5)
  const rows: EstimateRow[] = [
    { name: 'P(violation)', cells: both.map((of) => probability(of?.probability)), tone: 'b' },
    { name: `Interval, ${confidenceText(stated?.confidence)}`, cells: both.map(intervalOf) },
    ...shares.map((share) => ({
      name: <>{percent(share)} quantile of <Sign text={run.quantity || 'value'} />{ofUnit(run.unit)}</>,
      cells: both.map((of) => fixed(at(of, share), decimals)),
    })),
    ...(both.some((of) => of?.failed) ? [{ name: 'Failed draws, which count as violations', cells: both.map((of) => (of ? count(of.failed) : NONE)) }] : []),
    { name: 'Effective sample size', cells: both.map((of) => (of ? count(Math.floor(of.effective)) : NONE)) },
  ]
  return (
    <Table
      rows={rows}
      columns={[
        { head: 'Estimate', cell: ({ name }) => name },
        ...['Stated', 'Moved'].map((head, k) => ({ head, num: true, tone: toneOf, cell: ({ cells }: EstimateRow) => cells[k] })),
      ]}
    />
  )
}

interface EstimateRow {
  name: ReactNode
  cells: readonly string[]
  tone?: 'b'
}

const toneOf = ({ tone }: EstimateRow) => tone

const intervalOf = (of: Reweighted | undefined): string => (of?.low == null ? NONE : `${atLeast(of.low)} to ${atMost(of.high)}`)

function Slider({ knob, value, onChange }: { knob: Knob; value: number; onChange: (value: number) => void }) {
  const { parameter, title, stated, low, high } = knob
  const unit = knob.name === 'alpha' || knob.name === 'beta' ? '' : unitText(parameter.unit)
  const at = (of: number) => (of - low) / (high - low || 1)
  const shown = `${plain(value, 4)} ${unit}`.trim()
  return (
    <div className={styles.knob}>
      <span className={value === stated ? '' : 'b'} title={parameter.path}>
        <Sign text={parameter.symbol} path={parameter.path} />, {title}
      </span>
      <span className={clsx(layout.row, fields.scrub)}>
        <input
          type="range"
          aria-label={`${parameter.text || parameter.path}, ${title}`}
          aria-valuetext={shown}
          min={0}
          max={STEPS}
          step={1}
          value={Math.round(STEPS * at(value))}
          style={{ '--done': `${100 * at(value)}%` } as CSSProperties}
          onDoubleClick={() => onChange(stated)}
          onChange={(event) => onChange(low + (Number(event.target.value) / STEPS) * (high - low))}
        />
        <i title={`Stated ${plain(stated)}`} style={{ '--at': at(stated), background: 'var(--c-nom)' } as CSSProperties} />
      </span>
      <span className="num">{shown}</span>
    </div>
  )
}
