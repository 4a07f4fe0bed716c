// Compares published values with those of the run, if the campaign repeats a study, at the published point if given.
import { clsx } from 'clsx'
import { IconAlertTriangle } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { Fragment } from 'react'
import { asCampaign, type Campaign, type Published as PublishedValue } from '../../api/campaign'
import { libraryQuery } from '../../api/queries'
import type { Minimum } from '../../client'
import { decimalsFor, fixed, NONE, signed } from '../../format/numbers'
import { Card } from '../../ui/Card'
import { Sign } from '../../ui/Sign'
import { Table } from '../../ui/Table'
import { useNearOrPrint } from '../../ui/useNear'
import { type RunData, searchesOf } from '../data/data'
import { cards, lists, tables } from '../../ui/styles'

/** The shipped campaign that repeats the study: the one with these published values, whatever its name is now. */
export type Study = 'repeated' | 'changed' | 'not shipped'

/** How a campaign relates to the study of its published values; budgets, threshold and names do not matter. */
export function studyOf(campaign: Campaign, library: readonly Campaign[]): Study {
  const { published } = campaign
  const shipped = library.filter((item) => JSON.stringify(item.published) === JSON.stringify(published))
  if (shipped.length === 0) return 'not shipped'
  return shipped.some((item) => evaluated(item) === evaluated(campaign)) ? 'repeated' : 'changed'
}

/** What decides the values of a campaign's evaluations, and which there are. */
function evaluated({ scenario, simulator, uncertain, correlations, criterion, objectives }: Campaign): string {
  const { component, result, parameters, from_centre } = criterion
  return JSON.stringify([scenario, simulator, uncertain, correlations, component, result, parameters, from_centre, objectives])
}

function Changed() {
  return (
    <p className={clsx(cards.note, cards.warn)} style={{ margin: '4px 16px 8px' }}>
      <IconAlertTriangle className="i" aria-hidden />
      Scenario, bounds or criterion of this run differ from the study: the values need not agree.
    </p>
  )
}

export function Published({ data, className }: { data: RunData; className?: string }) {
  const { run, campaign } = data
  const [holder, near] = useNearOrPrint<HTMLDivElement>()
  // The library is large: read when needed.
  const library = useQuery({ ...libraryQuery, enabled: near && campaign.published !== undefined })
  const study = library.data && studyOf(campaign, library.data.map((item) => asCampaign(item.document)))
  const rows = (campaign.published ?? []).map((row) => ({ ...row, ours: oursFor(data, row) }))
  if (rows.length === 0) return null
  const decimals = decimalsFor(
    rows.map((row) => row.value),
    4,
  )
  return (
    <Card
      title="Published values"
      note={study === 'repeated' ? 'Of the study this campaign repeats' : study === 'changed' ? 'Of a study; this campaign differs from it' : 'As stated in the campaign file'}
      className={className}
      flush
      footer={campaign.notes ? <Notes text={campaign.notes} /> : undefined}
    >
      <div ref={holder}>{study === 'changed' && <Changed />}</div>
      <Table
        tight
        rows={rows}
        columns={[
          { head: 'Value', cell: (row) => <Value data={data} row={row} /> },
          { head: 'Published', unit: run.unit, cell: ({ value }) => fixed(value, decimals) },
          {
            head: 'Ours',
            unit: run.unit,
            tone: ({ ours }) => (typeof ours === 'number' ? 'b' : 'mut'),
            cell: ({ ours }) => (typeof ours === 'number' ? fixed(ours, decimals + 1) : ours === null ? 'no value' : 'not run'),
          },
          { head: 'Difference', unit: run.unit, tone: 'sec', cell: ({ ours, value }) => (typeof ours === 'number' ? signed(ours - value, decimals) : NONE) },
        ]}
      />
    </Card>
  )
}

function Value({ data, row }: { data: RunData; row: PublishedValue }) {
  return (
    <span className={tables.rn}>
      <span>{row.label}</span>
      <small>
        {[row.source, where(data, row)].filter(Boolean).map((part, i) => (
          <span key={i}>
            {i > 0 && ', '}
            {part}
          </span>
        ))}
      </small>
    </span>
  )
}

function Notes({ text }: { text: string }) {
  return (
    <details>
      <summary>How this campaign was made</summary>
      <p className={clsx('sec small', lists.about)}>{text}</p>
    </details>
  )
}

function where({ parameters }: RunData, row: PublishedValue) {
  const points = Object.entries(row.at ?? {})
  if (points.length === 0) return null
  return points.map(([path, value], i) => (
    <Fragment key={path}>
      {i > 0 && ', '}
      <span className="nw">
        <Sign text={parameters.find((p) => p.path === path)?.symbol ?? path} path={path} /> = {value}
      </span>
    </Fragment>
  ))
}

/**
 * The run's value for a published one: from the start named by its label, or by the method with which the label starts; null
 * if what was run has none, undefined if it was not run.
 */
export function oursFor(data: Pick<RunData, 'run' | 'stages' | 'evaluations' | 'catalogue'>, row: Pick<PublishedValue, 'label'>): number | null | undefined {
  const label = row.label.toLowerCase()
  if (label.startsWith('nominal')) return ran(data.run, data.run.nominal_cost)
  const searches = searchesOf(data)
  if (label.includes(' from ')) {
    const minima = searches.flatMap((search) => search.result?.minima ?? [])
    return minimumFrom(minima, row.label)?.cost
  }
  const search = searches.find(({ title, stage }) => {
    const words = [title, stage.method?.replaceAll('_', ' ') ?? ''].map((word) => word.toLowerCase())
    return words.some((word) => word && label.startsWith(word.split(' ')[0] ?? word))
  })
  return ran(search?.stage, search?.stage.best)
}

/** The value of what has evaluated something; undefined of what has not. */
const ran = (stage: { evaluations: number } | undefined, value: number | null | undefined): number | null | undefined =>
  stage && stage.evaluations > 0 ? (value ?? null) : undefined

/** The minimum reached from the start named by the label. */
function minimumFrom(minima: Minimum[], label: string): Minimum | undefined {
  const numbers = [...label.matchAll(/=\s*([\d.]+)/g)].map((match) => Number(match[1]))
  const near = (a: number, b: number) => Math.abs(a - b) < 1e-6 * Math.max(1, Math.abs(b))
  return minima.find(({ start }) => {
    const values = Object.values(start ?? {})
    return numbers.length > 0 && numbers.every((n) => values.some((v) => near(v, n)))
  })
}
