// How much of the box the evaluations cover: the largest empty ball, bins of pairs of parameters, the volume in which the
// slopes seen leave a violation possible. No proof, which the card states. It is read near the window or for a print.
import { useQuery } from '@tanstack/react-query'
import { useState } from 'react'
import { coverageQuery } from '../../api/queries'
import type { Coverage, PairCoverage } from '../../client'
import { count, decimalsFor, fixed, percent, plain, probability } from '../../format/numbers'
import { unitText } from '../../format/units'
import { Failed } from '../../page/Trouble'
import { Button } from '../../ui/Button'
import { Card, Progress, Stat } from '../../ui/Card'
import { Sign } from '../../ui/Sign'
import { Spans } from '../../ui/Spans'
import { Table } from '../../ui/Table'
import { useNearOrPrint } from '../../ui/useNear'
import type { RunData, UncertainParameter } from '../data/data'
import { layout } from '../../ui/styles'
import runStyles from '../run.module.css'
import styles from './space.module.css'

/** Initial number of pairs. */
const SHOWN = 6

type Shown = Pick<RunData, 'parameters'>

export function CoverageSection({ data }: { data: RunData }) {
  const [holder, near] = useNearOrPrint<HTMLDivElement>()
  const { data: coverage, error, refetch } = useQuery({ ...coverageQuery(data.run.id), enabled: near })
  return (
    <div className={layout.c12} id="coverage" style={{ minHeight: 260 }} ref={holder}>
      {coverage ? (
        <CoverageCard data={data} coverage={coverage} />
      ) : (
        <Card title="Coverage">
          {error ? <Failed error={error} retry={() => void refetch()} /> : <p className="mut">Loading the coverage …</p>}
        </Card>
      )}
    </div>
  )
}

export function CoverageCard({ data, coverage }: { data: Shown; coverage: Coverage }) {
  const { ball, pairs, bins, possible, statements } = coverage
  const [least] = pairs
  return (
    <Card title="Coverage" note="Of the parameter space by the evaluations of all stages; no proof" flush>
      <div className={runStyles.stats}>
        <Stat name="Radius of an empty ball" testId="radius" value={plain(ball?.radius, 3)} exact={ball?.radius} note={ball ? `each range is 1, the diagonal ${plain(ball.diagonal, 3)}` : 'no evaluation'} />
        <Stat name="Bins of the least covered pair" testId="least" value={least ? percent(least.touched / bins) : plain(null)} note={least ? `${least.touched} of ${bins} have an evaluation` : 'one parameter has no pair'} />
        <Stat
          name="Violation possible by the slopes seen"
          value={probability(possible?.fraction)}
          exact={possible?.fraction}
          note={possibleText(possible)}
        />
      </div>
      <div className={styles.covered}>
        <div>
          {statements.map((statement, i) => (
            <p key={i} className={i === statements.length - 1 ? 'b' : undefined}>
              <Spans spans={statement} exact />
            </p>
          ))}
        </div>
        {ball && <Centre parameters={data.parameters} centre={ball.centre} />}
        {least && least.touched < bins && pairs.length > 1 && <Pairs parameters={data.parameters} pairs={pairs} bins={bins} />}
      </div>
    </Card>
  )
}

/** A standard error of 0 would read as certainty. */
function possibleText(possible: Coverage['possible']): string {
  if (!possible) return 'no slope'
  const { fraction, standard_error, points } = possible
  if (standard_error > 0) return `of the box, ± ${probability(standard_error, 2)} standard error`
  return `${fraction > 0 ? 'all' : 'none'} of ${count(points)} random points`
}

function Centre({ parameters, centre }: Shown & { centre: Readonly<Record<string, number>> }) {
  return (
    <Table
      tight
      name="Centre of the empty ball"
      rows={parameters.filter(({ path }) => path in centre)}
      columns={[
        { head: 'Centre of the empty ball', tip: ({ text }: UncertainParameter) => text, cell: ({ symbol, path }) => <Sign text={symbol} path={path} /> },
        { head: 'Value', num: true, cell: ({ path, low, high, unit }) => `${fixed(centre[path], decimalsFor([low, high]))} ${unitText(unit)}` },
      ]}
    />
  )
}

function Pairs({ parameters, pairs, bins }: Shown & { pairs: readonly PairCoverage[]; bins: number }) {
  const [all, setAll] = useState(false)
  const sign = (path: string) => <Sign text={parameters.find((p) => p.path === path)?.symbol ?? path} path={path} />
  return (
    <div>
      <Table
        tight
        name="Pairs of parameters, the least covered first"
        rows={all ? pairs : pairs.slice(0, SHOWN)}
        columns={[
          { head: 'Pair, the least covered first', cell: ({ first, second }) => <>{sign(first)} and {sign(second)}</> },
          { head: `Of ${bins} bins`, num: true, cell: ({ touched }) => touched },
          { head: '', width: 90, cell: ({ touched }) => <Progress share={touched / bins} colour="var(--c-nom)" label="Bins with an evaluation" /> },
        ]}
      />
      {pairs.length > SHOWN && (
        <Button small onClick={() => setAll(!all)}>{all ? 'Show fewer' : `Show all ${pairs.length}`}</Button>
      )}
    </div>
  )
}
