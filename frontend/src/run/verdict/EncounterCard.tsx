// Evidence that the avoidance was exercised: closest approaches, motion, the case without avoidance, influence.
import type { ReactNode } from 'react'
import type { Beyond, ClosestApproach, Encounter, Later } from '../../client'
import { count, fixed, NONE, plain } from '../../format/numbers'
import { HelpLink } from '../../help/links'
import { Card } from '../../ui/Card'
import { Sign } from '../../ui/Sign'
import type { RunData } from '../data/data'
import { lists } from '../../ui/styles'

const AT: Record<ClosestApproach['at'], string> = {
  start: 'at the start of the horizon',
  end: 'at the end of the horizon',
  inside: 'inside the horizon',
  none: 'not known',
}

interface EncounterProps {
  data: RunData
  encounter: Encounter
}

export function EncounterCard({ data, encounter }: EncounterProps) {
  const { run, findings, parameters } = data
  const { closest, beyond, moved, unseen, spread, influence, no_value } = encounter
  const quantity = <Sign text={run.quantity || 'value'} />
  return (
    <Card
      title={unseen ? 'Encounter' : 'Effect of the parameters'}
      note={unseen ? 'Was the avoidance put to the test?' : 'This system models no encounter'}
      id="encounter"
      right={<HelpLink to="/help/evidence" at="vacuous">Why this is checked</HelpLink>}
    >
      <dl className={lists.kv}>
        {unseen && <Closest name="nominal" approach={closest} />}
        {findings.map((each) => each.closest && <Closest key={each.label} name={each.label} approach={each.closest} />)}
        {beyond && (
          <Onward beyond={beyond} measures={!!run.criteria[0]?.measured_to} quantity={quantity} unit={run.unit} />
        )}
        {unseen && (
          <>
            <dt>Path of the nominal case</dt>
            <dd>{moved === null ? NONE : `${plain(moved, 4)} m`}</dd>
            <dt>Nominal {quantity} without avoidance</dt>
            <dd data-testid="unseen">
              {unseen.cost === null ? `no value: ${unseen.reason}` : `${plain(unseen.cost)} ${run.unit}`}
              {run.nominal_cost !== null && (
                <span className="mut">
                  , with the avoider {plain(run.nominal_cost)} {run.unit}
                </span>
              )}
            </dd>
          </>
        )}
        <dt>Range of {quantity}</dt>
        <dd>
          {spread.lowest === null || spread.highest === null
            ? NONE
            : `${plain(spread.lowest)} to ${plain(spread.highest)} ${run.unit} over ${count(spread.evaluations)} evaluations`}
        </dd>
        <dt>Largest change by one parameter alone</dt>
        <dd>
          {Object.keys({ ...influence, ...no_value }).map((path, i) => (
            <span key={path}>
              {i > 0 && '; '}
              <Sign text={parameters.find((p) => p.path === path)?.symbol ?? path} path={path} />:{' '}
              {path in influence ? `${plain(influence[path], 3)} ${run.unit}` : 'not known'}
              {no_value?.[path] && <span className="unk-t"> (evaluations along it {ending(no_value[path])})</span>}
            </span>
          ))}
        </dd>
      </dl>
    </Card>
  )
}

function ending(statuses: readonly string[]) {
  const fail = statuses.some((status) => status !== 'ok' && status !== 'excluded')
  return [fail && 'fail', statuses.includes('excluded') && 'are excluded'].filter(Boolean).join(' or ')
}

function Closest({ name, approach: { time, at, obstacle } }: { name: string; approach: ClosestApproach }) {
  return (
    <>
      <dt>Closest approach, {name}</dt>
      <dd>
        {time !== null && `${fixed(time, 2)} s, `}
        <span className={at === 'inside' ? undefined : 'unk-t'}>{AT[at]}</span>
        {obstacle !== null && <span className="mut">, obstacle {obstacle + 1}</span>}
      </dd>
    </>
  )
}

interface Value {
  quantity: ReactNode
  unit: string
}

/** measures: whether the criterion is one of distances, without which nothing is extrapolated. */
function Onward({ beyond, measures, ...value }: Value & { beyond: Beyond; measures: boolean }) {
  const { closer, cut_short: failed, flights, not_continued, lowest, unknown } = beyond
  return (
    <>
      <dt>Beyond the horizon</dt>
      <dd data-testid="beyond">
        <span className={closer ? 'unk-t' : undefined}>
          {count(closer)} of {count(flights)} flights come closer
        </span>
        {not_continued ? <span className="mut">; {count(not_continued)} evaluations at most were not simulated on</span> : null}
        {failed ? (
          <span className="mut">
            ; {count(failed)} {failed === 1 ? 'fails' : 'fail'} after the horizon
            {measures && ', extrapolated from there'}
          </span>
        ) : null}
        {!measures && (
          <span className="mut">; nothing is known beyond {plain(beyond.times)} times the horizon</span>
        )}
        {lowest && !(unknown && unknown.value < lowest.value) && (
          <span className="mut">; lowest approach after it: {at(lowest, value)}</span>
        )}
        {unknown && (
          <span className="unk-t">
            ; not known how {unknown.vehicle ? 'the vehicle' : 'the obstacle'} moves on
            {typeof unknown.goal !== 'number' ? (
              <>: {at(unknown, value)}</>
            ) : (
              ` from its goal: ${unknown.name} comes there ${plain(unknown.goal, 4)} s after it was simulated`
            )}
          </span>
        )}
      </dd>
    </>
  )
}

function at(later: Later, { quantity, unit }: Value): ReactNode {
  return (
    <>
      {quantity} {plain(later.value, 4)} {unit}, {later.name}, obstacle {later.obstacle + 1}, {plain(later.distance, 4)} m
      away at the last sample, {later.closing > 0 ? 'closing' : 'moving away'} at {plain(Math.abs(later.closing), 4)} m/s
      {typeof later.until !== 'number' ? '' : `, fails after ${plain(later.until, 4)} s`}; {later.simulated ? 'reached' : 'extrapolated'}{' '}
      {plain(later.time, 4)} s later
    </>
  )
}
