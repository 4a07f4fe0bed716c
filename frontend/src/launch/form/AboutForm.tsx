// Descriptive fields of a campaign: name, summary, notes on sources and limits, published values.
import { IconPlus, IconTrash } from '@tabler/icons-react'
import { clsx } from 'clsx'
import type { ReactNode } from 'react'
import type { Campaign, Published } from '../../api/campaign'
import { Card } from '../../ui/Card'
import { Fold } from '../fields/Fold'
import { NumberCell } from '../fields/NumberCell'
import type { SetValue } from '../fields/PartCard'
import { FieldErrors, idOf } from '../fields/problems'
import buttons from '../../ui/buttons.module.css'
import fieldsCss from '../../ui/fields.module.css'
import layout from '../../ui/layout.module.css'
import styles from './form.module.css'

interface AboutFormProps {
  campaign: Campaign
  set: SetValue
}

export function AboutForm({ campaign, set }: AboutFormProps) {
  const published = campaign.published ?? []
  const told = published.length === 0 ? 'none' : `${published.length} to compare with ours`
  return (
    <Card title="About this campaign" id="section-about">
      <Fold title="Name and notes" digest={campaign.name} fields={['name', 'summary', 'notes', 'tags']}>
        <div className={layout.stack}>
          <Written field="campaign.name" label="Name of the campaign">
            <input
              id={idOf('campaign.name')}
              className={fieldsCss.inp}
              value={campaign.name}
              maxLength={120}
              onChange={(event) => set(['name'], event.target.value)}
            />
          </Written>
          <Written field="summary" label="Summary, one line for lists and cards">
            <input
              id={idOf('summary')}
              className={fieldsCss.inp}
              value={campaign.summary ?? ''}
              maxLength={400}
              onChange={(event) => set(['summary'], event.target.value)}
            />
          </Written>
          <Written field="notes" label="Notes: sources, what is reconstructed, what is not modelled">
            <textarea
              id={idOf('notes')}
              className={fieldsCss.inp}
              rows={6}
              value={campaign.notes ?? ''}
              onChange={(event) => set(['notes'], event.target.value)}
            />
          </Written>
        </div>
      </Fold>
      <Fold title="Published values" digest={told} fields={['published']}>
        <Values published={published} set={set} />
      </Fold>
    </Card>
  )
}

function Written({ field, label, children }: { field: string; label: string; children: ReactNode }) {
  return (
    <div className={styles.written}>
      <label className={fieldsCss.lbl} htmlFor={idOf(field)}>
        {label}
      </label>
      {children}
      <FieldErrors field={field} />
    </div>
  )
}

function Values({ published, set }: { published: Published[]; set: SetValue }) {
  return (
    <div className={layout.stack} id={idOf('published')} tabIndex={-1}>
      {published.map((one, i) => (
        <div key={i} className={clsx(layout.row, styles.published)}>
          <input
            className={fieldsCss.inp}
            aria-label={`Published value ${i + 1}, label`}
            placeholder="Label"
            value={one.label}
            onChange={(event) => set(['published', i, 'label'], event.target.value)}
          />
          <span style={{ width: 110 }}>
            <NumberCell
              field={`published.${i}.value`}
              label={`Published value ${i + 1}`}
              value={one.value}
              onChange={(value) => set(['published', i, 'value'], value ?? '')}
            />
          </span>
          <input
            className={fieldsCss.inp}
            aria-label={`Published value ${i + 1}, source`}
            placeholder="Source"
            value={one.source ?? ''}
            onChange={(event) => set(['published', i, 'source'], event.target.value)}
          />
          <span className="small mut nw">{Object.keys(one.at ?? {}).length > 0 && `at ${Object.keys(one.at ?? {}).length} values`}</span>
          <button
            type="button"
            className={buttons.iconbtn}
            aria-label={`Remove published value ${i + 1}`}
            onClick={() =>
              set(
                ['published'],
                published.filter((_, j) => j !== i),
              )
            }
          >
            <IconTrash className="i s" aria-hidden />
          </button>
          <FieldErrors field={`published.${i}`} deep />
        </div>
      ))}
      <span>
        <button
          type="button"
          className={clsx(buttons.btn, buttons.s)}
          onClick={() => set(['published'], [...published, { label: '', value: '', at: {}, source: '' }])}
        >
          <IconPlus className="i s" aria-hidden /> Add published value
        </button>
      </span>
    </div>
  )
}
