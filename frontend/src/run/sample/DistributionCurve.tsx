// The distribution function of the independent sample with its confidence band, and the bound on a quantile.
import { useMemo } from 'react'
import type { Distribution, Sample } from '../../client'
import { Plot } from '../../charts/Plot'
import type { PlotSpec } from '../../charts/spec'
import { atLeast, atMost, decimalsFor, fixed, probability } from '../../format/numbers'
import { ofUnit } from '../../format/units'
import { Sign, symbolText } from '../../ui/Sign'
import type { RunData } from '../data/data'

interface DistributionCurveProps {
  data: RunData
  sample: Sample & { distribution: Distribution }
  height: number
}

export function DistributionCurve({ data, sample, height }: DistributionCurveProps) {
  const { run } = data
  const spec = useMemo((): PlotSpec => {
    const { values, shares, band } = sample.distribution
    const decimals = decimalsFor([sample.mean, sample.lowest], 5)
    const { quantile } = sample
    const part = (share: number) => Math.min(1, Math.max(0, share))
    const within = (share: number) => 100 * part(share)
    // The band holds for what was drawn: nothing beyond the bounds was.
    const where = sample.outside > 0 ? ', within the bounds' : ''
    return {
      label: `Fraction of the sample at or below each ${symbolText(run.quantity || 'value')}`,
      x: values,
      lines: [
        { key: 'sample', label: 'Sample', colour: '--c-nom', y: shares.map(within), width: 1.8 },
        { key: 'low', label: `Lower band${where}`, colour: '--c-obs', y: shares.map((s) => within(s - band)), texts: shares.map((s) => atLeast(part(s - band))), width: 1 },
        { key: 'high', label: `Upper band${where}`, colour: '--c-obs', y: shares.map((s) => within(s + band)), texts: shares.map((s) => atMost(part(s + band))), width: 1 },
      ],
      points:
        quantile && quantile.bound !== null
          ? [{ x: quantile.bound, y: 100 * quantile.share, colour: '--c-worst' }]
          : [],
      xTitle: (
        <>
          <Sign text={run.quantity || 'value'} />{ofUnit(run.unit)}
        </>
      ),
      yTitle: 'Fraction of the sample, %',
      yRange: [0, 100],
      left: 48,
      height,
      xText: (x) => `${symbolText(run.quantity || 'value')} = ${fixed(x, decimals)} ${run.unit}`,
      yText: (y) => probability(y / 100),
    }
  }, [sample, run.quantity, run.unit, height])
  return <Plot spec={spec} />
}
