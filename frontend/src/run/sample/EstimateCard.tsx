// The estimate of P(violation): its interval on a logarithmic axis and the modes with their findings and shares; with an alarm no interval and no shares.
import { IconAlertTriangle } from '@tabler/icons-react'
import type { EstimationResult } from '../../api/stages'
import { TicksBelow } from '../../charts/axes'
import type { NamedModes, ViolationMode } from '../../client'
import { atLeast, atMost, count, percent, plain, probability as written } from '../../format/numbers'
import { sentence } from '../../format/spans'
import { Card } from '../../ui/Card'
import { Spans } from '../../ui/Spans'
import { Table } from '../../ui/Table'
import { useWidth } from '../../ui/useWidth'
import type { UncertainParameter } from '../data/data'
import { parameterColumns } from '../parameters/columns'
import { figures } from '../../ui/styles'

interface EstimateProps {
  parameters: readonly UncertainParameter[]
  result: EstimationResult
  /** Which findings the modes are; null before validation, and in runs of earlier versions. */
  named: NamedModes | null
}

export function EstimateCard({ parameters, result, named }: EstimateProps) {
  const { probability, low, high, alarms, modes, draws } = result
  const interval = probability !== null && low !== null && high !== null && { probability, low, high }
  return (
    <Card
      title="Estimate of P(violation)"
      note={draws > 0 ? `${count(draws)} weighted draws over the modes found` : undefined}
      id="estimate"
      footer={
        <>
          {alarms.length > 0 && <IconAlertTriangle color="var(--unk)" size={16} aria-label="Alarm" />}{' '}
          <Spans spans={sentence(result.statement)} />
          {named && <> <Spans spans={sentence(named.statement)} /></>}
        </>
      }
    >
      {interval && <Interval {...interval} />}
      {modes.length > 0 && (
        <Table
          tight
          rows={modes}
          columns={[
            { head: 'Mode', num: true, cell: (_, i) => i + 1 },
            { head: 'Finding', tip: () => FINDING, cell: (_, i) => named?.findings[i]?.join(', ') || '—' },
            ...(alarms.length > 0 ? [] : [{ head: 'Share of P', num: true, tone: 'b' as const, cell: ({ share }: ViolationMode) => percent(share) }]),
            { head: 'Distance', num: true, tip: () => 'Of its most likely point from the median, in standard deviations', cell: ({ distance }) => plain(distance, 3) },
            { head: 'Found by', tone: 'sec', cell: ({ origins }) => (origins.length > 0 ? 'a search' : 'the estimate') },
            ...parameterColumns<ViolationMode>(parameters, (mode, { path }) => plain(mode.parameters[path] ?? null, 5), 'path'),
          ]}
        />
      )}
    </Card>
  )
}

const FINDING = 'The straight line from the most likely point of the mode to the finding violates at four points'
const [HEIGHT, SIDE] = [64, 30]

/** The interval between whole powers of ten. */
function Interval({ probability, low, high }: { probability: number; low: number; high: number }) {
  const [holder, width] = useWidth(420)
  const least = Math.max(low, probability / 1e6, 1e-300)
  const [first, last] = [Math.floor(Math.log10(least)), Math.max(Math.ceil(Math.log10(high)), Math.floor(Math.log10(least)) + 1)]
  const x = (value: number) => SIDE + ((width - 2 * SIDE) * (Math.log10(Math.max(value, 10 ** first)) - first)) / (last - first)
  const step = Math.ceil((last - first) / Math.max(2, width / 80))
  const powers = Array.from({ length: Math.floor((last - first) / step) + 1 }, (_, i) => first + i * step)
  return (
    <div ref={holder}>
      <svg className={figures.ch} height={HEIGHT} role="img" aria-label={`P(violation) about ${written(probability, 2)}, interval ${atLeast(low, 2)} to ${atMost(high, 2)}`}>
        <path className={figures.a} d={`M${SIDE} ${HEIGHT - 24}H${width - SIDE}`} />
        <TicksBelow ticks={powers} at={(power) => x(10 ** power)} text={(power) => written(10 ** power, 1)} foot={HEIGHT - 24} top={8} />
        <rect x={x(low)} y={18} width={Math.max(2, x(high) - x(low))} height={14} fill="var(--c-worst)" fillOpacity={0.35} />
        <path d={`M${x(probability)} 14V36`} stroke="var(--c-worst)" strokeWidth={2} />
      </svg>
    </div>
  )
}
