// The other stages and the settings of the verdict, collapsed with a summary of each.
import { Card } from '../../ui/Card'
import { Choice, Labelled, NumberField } from '../fields/Field'
import { Fold } from '../fields/Fold'
import { FieldErrors, idOf } from '../fields/problems'
import type { FormProps } from '../fields/props'
import { type Setting, settingOf, settled, STAGES, VERDICT } from '../campaign/settings'
import styles from './form.module.css'

export function SettingsForm(form: FormProps) {
  return (
    <Card title="Certify, stages and verdict" id="section-stages">
      {STAGES.map(({ title, digest, settings }) => {
        const field = `stages.${title.toLowerCase()}`
        return (
          <Fold key={title} title={title} digest={digest(form.campaign)} fields={[field]}>
            <div className={styles.fields} id={idOf(field)} tabIndex={-1}>
              <SettingFields {...form} settings={settings} />
            </div>
            <FieldErrors field={field} />
          </Fold>
        )
      })}
      <h3 style={{ margin: '14px 0 8px' }}>Verdict</h3>
      <div className={styles.fields}>
        <SettingFields {...form} settings={VERDICT} />
      </div>
    </Card>
  )
}

interface SettingFieldsProps extends FormProps {
  settings: Setting[]
}

export function SettingFields({ campaign, set, settings }: SettingFieldsProps) {
  return settings.map((setting) => {
    const field = setting.at.join('.')
    if (setting.choices) {
      return (
        <Labelled key={field} field={field} label={setting.label} text={setting.text}>
          <Choice
            field={field}
            aria-label={setting.label}
            data={setting.choices}
            value={String(settingOf(campaign, setting) ?? setting.choices[0]?.value)}
            onChange={(value) => set(setting.at, value)}
          />
        </Labelled>
      )
    }
    return (
      <NumberField
        key={field}
        field={field}
        label={setting.label}
        unit={setting.unit}
        text={setting.text}
        value={settingOf(campaign, setting)}
        optional={setting.empty !== undefined}
        placeholder={typeof setting.empty === 'function' ? setting.empty(campaign) : setting.empty}
        onChange={(value) => set(...settled(setting, value))}
      />
    )
  })
}
