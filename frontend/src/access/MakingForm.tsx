// The form that makes an invitation or a token: a name, what it may do, and the foot with what was refused.
import { clsx } from 'clsx'
import { type ReactNode, useState } from 'react'
import { Field, Form } from '../ui/Form'
import styles from './access.module.css'
import { fields } from '../ui/styles'

interface MakingFormProps {
  hint: ReactNode
  /** The choices below the name. */
  children: ReactNode
  /** The request that makes it. */
  sent: { isPending: boolean; error: Error | null }
  /** The words of the button, also while the answer is awaited. */
  make: string
  making: string
  onMake: (name: string) => void
  onDone: () => void
}

export function MakingForm({ hint, children, sent, make, making, onMake, onDone }: MakingFormProps) {
  const [typed, setTyped] = useState('')
  const name = typed.trim()
  return (
    <Form sent={sent} send={sent.isPending ? making : make} off={!name} onSend={() => onMake(name)} onLeave={onDone}>
      <Field label="Name" value={typed} maxLength={64} required autoCapitalize="none" autoComplete="off" spellCheck={false} data-autofocus onChange={setTyped}>
        <span className={clsx('small mut', styles.hint)}>{hint}</span>
      </Field>
      {children}
    </Form>
  )
}

interface MayChoiceProps<T extends string> {
  /** Role or scope. */
  title: string
  value: T
  options: readonly { value: T; may: string }[]
  onChange: (value: T) => void
}

/** One of several, each with what it permits. */
export function MayChoice<T extends string>({ title, value, options, onChange }: MayChoiceProps<T>) {
  return (
    <fieldset className={styles.choices}>
      <legend className={fields.lbl}>{title}</legend>
      {options.map((option) => (
        <label key={option.value} className={fields.pickrow}>
          <input type="radio" name={title.toLowerCase()} checked={option.value === value} onChange={() => onChange(option.value)} />
          <span>
            <b>{option.value}</b> <span className="sec">{option.may}</span>
          </span>
        </label>
      ))}
    </fieldset>
  )
}
