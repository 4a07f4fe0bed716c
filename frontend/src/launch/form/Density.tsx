// The distribution of a parameter over its bounds, as used by the independent sample; the tick is the nominal value.
import type { Uncertain } from '../../api/campaign'
import { numberOf } from '../campaign/parameters'

interface DensityProps {
  low: number | null
  high: number | null
  nominal: number | null
  distribution: Uncertain['distribution']
}

const [W, H, STEPS] = [92, 22, 40]

export function Density({ low, high, nominal, distribution }: DensityProps) {
  if (low === null || high === null || !(low < high)) return <svg width={W} height={H} aria-hidden="true" />
  const share = densityOf(distribution, low, high)
  const values = Array.from({ length: STEPS + 1 }, (_, i) => share(low + ((high - low) * i) / STEPS))
  const top = Math.max(...values) || 1
  const x = (i: number) => 2 + ((W - 4) * i) / STEPS
  const outline = values.map((v, i) => `L${x(i).toFixed(1)} ${(H - 3 - (v / top) * 13).toFixed(1)}`).join('')
  const at = nominal === null ? null : 2 + ((W - 4) * (nominal - low)) / (high - low)
  return (
    <svg width={W} height={H} viewBox={`0 0 ${W} ${H}`} aria-hidden="true">
      <path d={`M2 ${H - 3}${outline}L${W - 2} ${H - 3}Z`} fill="var(--vp-2)" stroke="var(--c-nom)" />
      {at !== null && at >= 2 && at <= W - 2 && <path d={`M${at} 3v${H - 4}`} stroke="var(--ink)" strokeWidth={1.6} />}
    </svg>
  )
}

function densityOf(distribution: Uncertain['distribution'], low: number, high: number): (value: number) => number {
  const mean = numberOf(distribution?.mean)
  const deviation = numberOf(distribution?.deviation)
  const mode = numberOf(distribution?.mode)
  if ((distribution?.kind === 'truncated_normal' || distribution?.kind === 'normal') && mean !== null && deviation)
    return (v) => Math.exp(-0.5 * ((v - mean) / deviation) ** 2)
  if (distribution?.kind === 'triangular' && mode !== null)
    return (v) => (v < mode ? (v - low) / (mode - low || 1) : (high - v) / (high - mode || 1))
  const [alpha, beta] = [numberOf(distribution?.alpha), numberOf(distribution?.beta)]
  if (distribution?.kind === 'beta' && alpha && beta) {
    // Densities with shape below one are unbounded at a bound: the outline stops before it.
    const inside = (v: number) => Math.min(0.99, Math.max(0.01, (v - low) / (high - low)))
    const log = (u: number) => (alpha - 1) * Math.log(u) + (beta - 1) * Math.log(1 - u)
    const mode = alpha > 1 && beta > 1 ? (alpha - 1) / (alpha + beta - 2) : 0.5
    return (v) => Math.exp(log(inside(v)) - log(Math.min(0.99, Math.max(0.01, mode))))
  }
  return () => 1
}
