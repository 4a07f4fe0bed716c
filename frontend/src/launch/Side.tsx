// The side panel: name, tags and criterion of the run, and its estimated effort.
import { DEFAULTS } from '../api/rules'
import { TagsInput } from '@mantine/core'
import { Fragment } from 'react'
import type { Campaign } from '../api/campaign'
import { optionsOf } from '../api/schema'
import type { Catalogue, Checked, ComponentEntry, ResultEntry } from '../client'
import { boundText } from '../format/counts'
import { confidenceText, count, goal, thinned, NONE } from '../format/numbers'
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
import { fields, lists } from '../ui/styles'

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
  catalogue: Catalogue
}

export function Estimate({ checked, campaign, catalogue }: EstimateProps) {
  const samples = samplesOf(campaign, catalogue)
  const unbounded = Object.values(campaign.uncertain).some((u) => u.distribution?.kind === 'normal')
  const confidence = numberOf(campaign.confidence) ?? DEFAULTS.confidence
  const target = numberOf(campaign.target_probability)
  // With no violation among n independent samples, the Clopper-Pearson bound is 1 - (1 - confidence)^(1/n).
  const bound = samples && samples >= 1 ? 1 - (1 - confidence) ** (1 / samples) : null
  const estimate = checked?.estimate
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
        {bound !== null && (
          <>
            <dt>Bound on P(violation)</dt>
            <dd>{boundText(bound, campaign.stages.certify ? 'certify' : 'search')}</dd>
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
        {bound !== null &&
          `The bound holds with ${confidenceText(confidence)} confidence if none of the ${count(samples)} random samples violates.`}
        {bound !== null && unbounded && ' The probability beyond the bounds of normal distributions is added to it.'}
      </p>
    </Card>
  )
}

/** The size of the sample for the statistical statement: that of certify, else of a random search with its own options. */
function samplesOf({ stages }: Campaign, { methods }: Catalogue): number | null {
  if (stages.certify) return numberOf(stages.certify.samples ?? DEFAULTS.samples)
  const random = new Map(methods.filter(({ kind }) => kind === 'random').map((method) => [method.name, optionsOf(method)]))
  const independent = stages.search.find(({ method, options = {} }) => {
    const usual = random.get(method)
    return usual && Object.entries(options).every(([name, value]) => value === usual[name]?.default)
  })
  return numberOf(independent?.evaluations)
}
