// Worst margins and bounds on P(violation) of runs, one above the other, with a shared crosshair.
import { clsx } from 'clsx'
import { Sign } from '../ui/Sign'
import { VerdictBadge } from '../ui/VerdictBadge'
import { type At, type Axis, boundName, boundsOf, commonOf, isBare, type Kind, kindsOf, marginsOf, observedName, spoken } from './outcomes'
import { layout } from '../ui/styles'
import styles from './outcomes.module.css'
import { Plot } from './Plot'

interface OutcomesChartProps {
  points: readonly At[]
  axis: Axis
  /** Key of the shared crosshair. */
  sync: string
  name: (point: At) => string
}

export function OutcomesChart({ points, axis, sync, name }: OutcomesChartProps) {
  const common = commonOf(points)
  const bounds = boundsOf(points, axis, 150, sync)
  // Only the lower chart has a title of its axis.
  const margins = marginsOf(points, bounds ? { ...axis, xTitle: undefined } : axis, 250, sync)
  const bare = kindsOf(points.filter(isBare))
  if (!common) return <p className="sec">The runs have values of different units, which one axis cannot show. The table has them.</p>
  if (!margins) return <p className="sec">No run has a worst margin yet.</p>
  return (
    <>
      <Plot
        spec={{
          ...margins,
          left: 58,
          yTitle: (
            <>
              Worst margin of <Sign text={common.quantity || 'value'} />
              {common.unit && `, ${common.unit}`}
            </>
          ),
        }}
      />
      {bounds && <Plot spec={{ ...bounds, left: 58, yTitle: 'P(violation), %' }} />}
      <div className={clsx(layout.row, 'sec', styles.legend)}>
        {kindsOf(points.filter((point) => !isBare(point))).map((kind) => <Named key={kind} kind={kind} />)}
        {bounds && (
          <>
            <span className={styles.key}>
              <i className={styles.dot} style={{ background: 'var(--c-bound)' }} /> {boundName(points)}
            </span>
            <span className={styles.key}>
              <i className={styles.dot} style={{ background: 'var(--c-nom)' }} /> {observedName(points)}
            </span>
          </>
        )}
        {axis.rules && axis.rules.length > 0 && (
          <span className={styles.key}>
            <i className={styles.rule} style={{ borderColor: 'var(--link)' }} /> Code changed
          </span>
        )}
        {bare.length > 0 && (
          <span className={styles.key}>
            <i className={styles.rule} /> No worst margin:
            {bare.map((kind) => <Named key={kind} kind={kind} />)}
          </span>
        )}
      </div>
      <p className="sr">{spoken(points, name)}</p>
    </>
  )
}

function Named({ kind }: { kind: Kind }) {
  if (kind === 'purged') return <span>purged</span>
  if (kind === 'contradicted') return <VerdictBadge outcome="inconclusive" word="Cleared: contradicted" />
  return <VerdictBadge outcome={kind} />
}
