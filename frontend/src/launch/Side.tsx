// The side panel: name, tags and criterion of the run, and its estimated effort.
import { TagsInput } from '../overlay/fields'
import { IconAlertTriangle } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { Fragment } from 'react'
import type { Campaign } from '../api/campaign'
import type { Checked, ComponentEntry, ResultEntry } from '../client'
import { boundText } from '../format/counts'
import { goal, thinned, NONE } from '../format/numbers'
import { unitText } from '../format/units'
import { Card } from '../ui/Card'
import { Sign } from '../ui/Sign'
import { Labelled, NumberField } from './fields/Field'
import { numberOf } from './campaign/parameters'
import { FieldErrors, idOf } from './fields/problems'
import type { SetValue } from './fields/props'
import type { Regression } from './regression/regression'
import { amountOf, stageAmountOf, timeOf } from './estimate'
import { RegressionFields } from './regression/RegressionFields'
import { cards, fields, lists } from '../ui/styles'

interface RunCardProps {
  name: string
  tags: string[]
  campaign: Campaign
  /** Whether form and text agree; otherwise the criterion cannot be edited here. */
  readable: boolean
  criterion: ComponentEntry | ResultEntry | undefined
  regression: Regression
  onName: (name: string) => void
  onTags: (tags: string[]) => void
  set: SetValue
}

export function RunCard({ name, tags, campaign, readable, criterion, regression, onName, onTags, set }: RunCardProps) {
  return (
    <Card title="Run">
      <div style={{ display: 'grid', gap: 12 }}>
        <Labelled field="name" label="Name">
          <span className={fields.inp}>
            <input id={idOf('name')} value={name} maxLength={120} onChange={(event) => onName(event.target.value)} />
          </span>
        </Labelled>
        <div>
          <TagsInput
            id={idOf('tags')}
            label="Tags"
            value={tags}
            placeholder={tags.length === 0 ? 'Enter adds a tag' : undefined}
            onChange={onTags}
          />
          <FieldErrors field="tags" deep />
        </div>
        <NumberField
          field="criterion.threshold"
          label="Criterion, threshold"
          title={
            <>
              Criterion: <Sign text={criterion?.quantity || 'value'} /> greater than
              {criterion?.unit && `, ${unitText(criterion.unit)}`}
            </>
          }
          value={campaign.criterion.threshold}
          disabled={!readable}
          onChange={(value) => set(['criterion', 'threshold'], value ?? '')}
        />
        <RegressionFields regression={regression} />
      </div>
    </Card>
  )
}

interface EstimateProps {
  checked: Checked | undefined
  campaign: Campaign
}

export function Estimate({ checked, campaign }: EstimateProps) {
  const target = numberOf(campaign.target_probability)
  const estimate = checked?.estimate
  const bound = checked?.predicted_bound
  return (
    <Card title="Estimate">
      <dl className={lists.kv}>
        <dt>Evaluations</dt>
        <dd>{estimate ? amountOf(estimate) : NONE}</dd>
        {estimate?.stages.map((stage) => (
          <Fragment key={stage.title}>
            <dt className="mut">· {stage.title}</dt>
            <dd className="mut">{stageAmountOf(stage, estimate.run)}</dd>
          </Fragment>
        ))}
        <dt>Time</dt>
        <dd>{estimate ? (timeOf(estimate) ?? 'not known') : NONE}</dd>
        {bound && (
          <>
            <dt>Bound on P(violation), at best</dt>
            <dd>≤ {boundText({ upper_bound: bound.upper_bound, bound_source: bound.source })}</dd>
          </>
        )}
        {target !== null && (
          <>
            <dt>Target</dt>
            <dd>{goal(target)}</dd>
          </>
        )}
      </dl>
      <p className="small mut" style={{ marginTop: 8 }}>
        {estimate && thinned(`${estimate.statement} ${estimate.time_statement} `)}
        {bound && thinned(bound.statement)}
      </p>
      {checked?.foreseen?.map(({ statement }) => (
        <p key={statement} className={clsx(cards.note, cards.warn)} role="note" style={{ marginTop: 12 }}>
          <IconAlertTriangle className="i" aria-hidden />
          <span>{thinned(statement)}</span>
        </p>
      ))}
    </Card>
  )
}
