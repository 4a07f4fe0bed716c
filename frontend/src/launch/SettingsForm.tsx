// The rest of a campaign: horizon and step, sensitivity, validation, agreement, target, seed.
import type { ReactNode } from 'react'
import { type Campaign, type Raw, read } from '../api/campaign'
import { Card } from '../ui/Card'
import { NumberCell } from './NumberCell'
import { FieldErrors, idOf } from './problems'

interface Setting {
  at: (string | number)[]
  label: string
  unit?: string
  text: string
  /** May be left empty: then this stands for it. */
  empty?: string
}

const GROUPS: { title: string; settings: Setting[] }[] = [
  {
    title: 'Simulation',
    settings: [
      { at: ['scenario', 'horizon'], label: 'Horizon', unit: 's', text: 'Length of a flight' },
      { at: ['scenario', 'step'], label: 'Step', unit: 's', text: 'Of the fourth-order Runge-Kutta method' },
      {
        at: ['scenario', 'guidance', 'period'],
        label: 'Guidance period',
        unit: 's',
        text: '0: the avoider is asked continuously',
      },
    ],
  },
  {
    title: 'Stages',
    settings: [
      {
        at: ['stages', 'sensitivity', 'points'],
        label: 'Sensitivity points',
        text: 'Per parameter, one at a time; empty leaves the stage out',
        empty: 'left out',
      },
      {
        at: ['stages', 'sensitivity', 'morris', 'trajectories'],
        label: 'Morris trajectories',
        text: 'Elementary effects over the whole box',
        empty: 'left out',
      },
      {
        at: ['stages', 'sensitivity', 'sobol', 'samples'],
        label: 'Sobol samples',
        text: 'Shares of the variance; a power of two',
        empty: 'left out',
      },
      {
        at: ['stages', 'certify', 'samples'],
        label: 'Certify samples',
        text: 'Independent flights that probabilities are claimed from; empty leaves the stage out',
        empty: 'left out',
      },
      {
        at: ['stages', 'certify', 'quantile'],
        label: 'Certify quantile',
        text: 'Share of the flights whose value is bounded from below',
      },
      {
        at: ['stages', 'validate', 'tolerance'],
        label: 'Validation tolerance',
        text: 'Share of the value, against half the step and the other integrator',
      },
      { at: ['stages', 'validate', 'neighbours'], label: 'Neighbours', text: 'Flown around each finding' },
      { at: ['stages', 'validate', 'reach'], label: 'Reach of neighbours', text: 'Share of each range' },
    ],
  },
  {
    title: 'Verdict',
    settings: [
      {
        at: ['agreement'],
        label: 'Agreement',
        text: 'Share of nominal minus worst within which the global methods must agree',
      },
      {
        at: ['target_probability'],
        label: 'Target for P(violation)',
        text: 'The upper bound from the certify stage must meet it',
        empty: 'none',
      },
      { at: ['confidence'], label: 'Confidence', text: 'Of the statistical bound' },
      { at: ['seed'], label: 'Seed', text: 'All random numbers come from it' },
    ],
  },
]

interface SettingsFormProps {
  campaign: Campaign
  set: (at: readonly (string | number)[], value: unknown) => void
}

export function SettingsForm({ campaign, set }: SettingsFormProps) {
  const change = ({ at, empty }: Setting, value: Raw | null) => {
    // A stage or a study that loses its first number is left out; the others of it go with it.
    if (value === null && at[0] === 'stages' && empty !== undefined) set(at.slice(0, -1), null)
    else set(at, value === null && empty !== undefined ? null : (value ?? ''))
  }
  return (
    <Card title="Simulation, stages and verdict">
      {GROUPS.map((group) => (
        <Group key={group.title} title={group.title}>
          {group.settings.map((setting) => {
            const field = setting.at.join('.')
            return (
              <div key={field}>
                <label className="lbl" htmlFor={idOf(field)}>
                  {setting.label}
                  {setting.unit && <span className="mut">, {setting.unit}</span>}
                </label>
                <NumberCell
                  field={field}
                  label={setting.label}
                  value={read(campaign, setting.at) as Raw | null | undefined}
                  optional={setting.empty !== undefined}
                  placeholder={setting.empty}
                  onChange={(value) => change(setting, value)}
                />
                <small>{setting.text}</small>
                <FieldErrors field={field} />
              </div>
            )
          })}
        </Group>
      ))}
    </Card>
  )
}

function Group({ title, children }: { title: string; children: ReactNode }) {
  return (
    <>
      <h3 style={{ margin: '10px 0 8px' }}>{title}</h3>
      <div className="fields">{children}</div>
    </>
  )
}
