// Descriptive fields of a campaign: name, summary, notes on sources and limits, published values.
import { IconPlus } from '@tabler/icons-react'
import { clsx } from 'clsx'
import type { Published } from '../../api/campaign'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { Labelled, RemoveButton } from '../fields/Field'
import { Fold } from '../fields/Fold'
import { NumberCell } from '../fields/NumberCell'
import type { FormProps, SetValue } from '../fields/props'
import { FieldErrors, idOf } from '../fields/problems'
import { fields as fieldsCss, layout } from '../../ui/styles'
import styles from './form.module.css'

interface WrittenText {
  at: 'name' | 'summary' | 'notes'
  /** The service's name of the field, if it differs. */
  field?: string
  label: string
  rows?: number
  most?: number
}

const TEXTS: readonly WrittenText[] = [
  { at: 'name', field: 'campaign.name', label: 'Name of the campaign', most: 120 },
  { at: 'summary', label: 'Summary, one line for lists and cards', most: 400 },
  { at: 'notes', label: 'Notes: sources, what is reconstructed, what is not modelled', rows: 6 },
]

export function AboutForm({ campaign, set }: FormProps) {
  const published = campaign.published ?? []
  const digest = published.length === 0 ? 'none' : `${published.length} to compare with ours`
  return (
    <Card title="About this campaign" id="section-about">
      <Fold title="Name and notes" digest={campaign.name} fields={['name', 'summary', 'notes', 'tags']}>
        <div className={layout.stack}>
          {TEXTS.map(({ at, field = at, label, rows, most }) => {
            const Input = rows ? 'textarea' : 'input'
            return (
              <Labelled key={at} field={field} label={label}>
                <Input
                  id={idOf(field)}
                  className={clsx(fieldsCss.inp, rows && fieldsCss.area)}
                  rows={rows}
                  maxLength={most}
                  value={campaign[at] ?? ''}
                  onChange={(event) => set([at], event.target.value)}
                />
              </Labelled>
            )
          })}
        </div>
      </Fold>
      <Fold title="Published values" digest={digest} fields={['published']}>
        <Values published={published} set={set} />
      </Fold>
    </Card>
  )
}

function Values({ published, set }: { published: Published[]; set: SetValue }) {
  const text = (one: Published, i: number, key: 'label' | 'source') => (
    <input
      className={fieldsCss.inp}
      aria-label={`Published value ${i + 1}, ${key}`}
      placeholder={key === 'label' ? 'Label' : 'Source'}
      value={one[key] ?? ''}
      onChange={(event) => set(['published', i, key], event.target.value)}
    />
  )
  return (
    <div className={layout.stack} id={idOf('published')} tabIndex={-1}>
      {published.map((one, i) => (
        <div key={i} className={clsx(layout.row, styles.published)}>
          {text(one, i, 'label')}
          <span style={{ width: 110 }}>
            <NumberCell
              field={`published.${i}.value`}
              label={`Published value ${i + 1}`}
              value={one.value}
              onChange={(value) => set(['published', i, 'value'], value ?? '')}
            />
          </span>
          {text(one, i, 'source')}
          <span className="small mut nw">{Object.keys(one.at ?? {}).length > 0 && `at ${Object.keys(one.at ?? {}).length} values`}</span>
          <RemoveButton label={`Remove published value ${i + 1}`} onClick={() => set(['published'], published.toSpliced(i, 1))} />
          <FieldErrors field={`published.${i}`} deep />
        </div>
      ))}
      <span>
        <Button small icon={IconPlus} onClick={() => set(['published'], [...published, { label: '', value: '', at: {}, source: '' }])}>
          Add published value
        </Button>
      </span>
    </div>
  )
}
