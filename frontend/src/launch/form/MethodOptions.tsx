// The options of a method, as a form generated from their JSON schema, and its start points.
import { IconPlus } from '@tabler/icons-react'
import { clsx } from 'clsx'
import type { Json, SearchStage } from '../../api/campaign'
import type { MethodEntry } from '../../client'
import { About } from '../../help/Docstring'
import { HelpLink } from '../../help/links'
import { Sign } from '../../ui/Sign'
import { Button } from '../../ui/Button'
import { Choice, Labelled, RemoveButton } from '../fields/Field'
import { NumberCell } from '../fields/NumberCell'
import { numberOf } from '../campaign/parameters'
import { boundsOf, optionsOf, type Schema } from '../../api/schema'
import { FieldErrors } from '../fields/problems'
import type { FormProps } from '../fields/props'
import { fields as fieldsCss, layout } from '../../ui/styles'
import styles from './form.module.css'

interface MethodOptionsProps extends Pick<FormProps, 'parameters' | 'set'> {
  field: string
  at: (string | number)[]
  stage: SearchStage
  method: MethodEntry
}

export function MethodOptions(props: MethodOptionsProps) {
  const { field, at, stage, method, set } = props
  const rules = Object.entries(optionsOf(method))
  return (
    <div style={{ padding: '4px 0 12px', display: 'grid', gap: 12 }}>
      {rules.length > 0 && (
        <div className={styles.fields}>
          {rules.map(([name, rule]) => (
            <Option
              key={name}
              field={`${field}.options.${name}`}
              name={name}
              rule={rule}
              value={stage.options?.[name]}
              onChange={(value) => set([...at, 'options', name], value)}
            />
          ))}
        </div>
      )}
      {rules.length === 0 && <p className="small mut">This method has no settings except its budget.</p>}
      {(method.starts || (stage.starts?.length ?? 0) > 0) && <Starts {...props} />}
      <About summary={`What ${method.title} does`} text={method.text}>
        <HelpLink to="/help/methods" at={method.name}>In the help</HelpLink>
      </About>
    </div>
  )
}

interface OptionProps {
  field: string
  name: string
  rule: Schema
  value: Json | undefined
  onChange: (value: Json | undefined) => void
}

function Option({ field, name, rule, value, onChange }: OptionProps) {
  const words = name.replaceAll('_', ' ')
  const label = words.charAt(0).toUpperCase() + words.slice(1)
  const choices = rule.enum?.map(String) ?? (rule.type === 'boolean' ? ['true', 'false'] : null)
  const shown = value ?? rule.default ?? null
  const chosen = (text: string) => onChange(rule.type === 'boolean' ? text === 'true' : text)
  return (
    <Labelled
      field={field}
      label={label}
      text={
        <>
          {[rule.description, boundsOf(rule)].filter(Boolean).join(', ')}
        </>
      }
    >
      {choices ? (
        <Choice field={field} data={choices} value={typeof shown === 'object' ? null : String(shown)} onChange={chosen} />
      ) : (
        <NumberCell
          field={field}
          label={label}
          value={typeof shown === 'number' || typeof shown === 'string' ? shown : null}
          optional
          placeholder={rule.default === null ? 'not set' : undefined}
          onChange={(number) => onChange(number ?? undefined)}
        />
      )}
    </Labelled>
  )
}

function Starts({ field, at, stage: { starts = [] }, method: { title }, parameters, set }: MethodOptionsProps) {
  const paths = [...new Set(starts.flatMap((start) => Object.keys(start)))]
  const add = () => {
    const nominal = parameters.filter((p) => p.path in (starts[0] ?? {}) || starts.length === 0)
    const start = Object.fromEntries(nominal.map((p) => [p.path, numberOf(p.nominal) ?? 0]))
    set([...at, 'starts'], [...starts, start])
  }
  return (
    <div>
      <span className={fieldsCss.lbl}>Starts</span>
      {starts.length === 0 && <p className="small mut">None given: the method chooses its own.</p>}
      {starts.map((start, i) => (
        <div key={i} className={layout.row} style={{ marginBottom: 4, flexWrap: 'wrap' }}>
          {paths.map((path) => (
            <span key={path} className={clsx(layout.row, 'small')} style={{ gap: 5 }}>
              <Sign text={parameters.find((p) => p.path === path)?.entry.symbol ?? path} />
              <span style={{ width: 96 }}>
                <NumberCell
                  field={`${field}.starts.${i}.${path}`}
                  label={`${title}, start ${i + 1}, ${path}`}
                  value={start[path]}
                  optional
                  placeholder="nominal"
                  onChange={(value) => set([...at, 'starts', i, path], value ?? undefined)}
                />
              </span>
            </span>
          ))}
          <RemoveButton label={`Remove start ${i + 1} of ${title}`} onClick={() => set([...at, 'starts'], starts.toSpliced(i, 1))} />
          <FieldErrors field={`${field}.starts.${i}`} deep />
        </div>
      ))}
      <Button small icon={IconPlus} aria-label={`Add start of ${title} at nominal`} onClick={add}>
        Add start at nominal
      </Button>
    </div>
  )
}
